"""Pure models: SI in, SI out, arrays broadcast; formula, range and source in every docstring.

A number outside a model's domain gives NaN, and the other elements of an array keep their values.
So does geometry that cannot be: a negative length, area or volume, an outer radius not above the
inner one, a rod not inside its bore (`actuator_opt.geometry`). A search without a solution, a word
that is no choice, and lists of unequal lengths raise ValueError where the docstring says so.
"""
