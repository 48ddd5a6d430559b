"""Settings every test shares."""

from __future__ import annotations

import os

from hypothesis import settings

# A loaded machine is no failure; continuous integration tries the same examples every time.
settings.register_profile("house", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("house")
