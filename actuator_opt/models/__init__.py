"""Pure models: SI in, SI out, arrays broadcast; formula, range and source in every docstring."""
