"""The front of several objectives: designs that are better in none without being worse in another.

`objectives` what is wanted · `ends` the best of each objective ·
`references` where along the front · `tracer` the designs there · `search` those found so far ·
`line`, `plane` where more are wanted, of two objectives or more · `overlooked` searches anew ·
`dominance` which of them count · `front` all together.
"""
