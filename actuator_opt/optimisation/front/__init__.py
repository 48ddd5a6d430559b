"""The Pareto front of several objectives: designs that no other design dominates.

`objectives` defines the problem · `ends` the best of each objective · `references` the levels along
the front · `tracer` the designs there · `search` the designs so far · `line`, `plane` fill the
front of two objectives or more · `overlooked` searches independently · `dominance` selects the
designs that count · `front` combines all.
"""
