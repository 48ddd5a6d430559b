"""The studio: a local page on which a design is the optimum again while a limit is dragged.

`model` solves, prices and saves; `worker` runs it on one thread, where a newer wish replaces an
older one; `server` lets one page on this machine ask for that; `page` assembles this page.
"""
