"""The front of several objectives: designs that are better in none without being worse in another.

`objectives` what is wanted · `references` where along the front · `tracer` the designs there ·
`dominance` which of them count · `front` all together.
"""
