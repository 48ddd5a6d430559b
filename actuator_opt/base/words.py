"""Names nearest to a word: by letters, by synonyms of the trade, and by what the names mean.

Every "did you mean" of the program, and the search of `explain` and `list`, ask this module. The
meaning of a name comes from its own declaration (label of a metric or material, help of a key), so
`SYNONYMS` only lists words that the declarations do not use.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache

LONGEST = 80
"""Largest number of characters of a word for which near names are sought."""

SYNONYMS = """
mass weight heavy light
stiffness rigidity spring compliance wobble
stroke travel
rod shaft
barrel tube
piston plunger
head gland
cap lid cover
clevis eye lug
retention joint fixing attachment
bond glue adhesive bonding
thread screw
seal packing gasket
compound elastomer rubber
o_ring oring
wiper scraper
guide bushing
back_up backup antiextrusion
friction drag
breakaway stiction
damping damper
frequency eigenfrequency resonance
buckling buckle euler
burst rupture break
fatigue endurance life
price sensitivity multiplier
flow discharge
velocity speed
force load thrust
torque moment
gap clearance play
squeeze precompression
growth expansion swelling
leakage leak
film lubrication
fluid oil liquid
layup laminate stack
angle orientation
lines hose pipe tubing
objective goal
requirement limit constraint
mount fixture
titanium ti
aluminium aluminum alu al
carbon cfrp t700 t700s t700sc t700gc t800 t800s t300 im7 as4 graphite
glass gfrp fibreglass fiberglass
aramid kevlar
polyamide nylon pa pa6 pa12
acetal pom delrin
ptfe teflon
nbr nitrile buna
e355 st52
fkm viton
polyurethane pu tpu urethane
polyethylene pe uhmw hdpe
stainless inox
"""
"""Words of one meaning, a line for each meaning. The first is the word of design files; of equally
near names, that with the earlier word of a line comes first."""

_STOP = frozenset(
    {
        "a", "an", "and", "are", "at", "by", "do", "does", "for", "from", "how", "in", "is", "it",
        "my", "of", "on", "or", "the", "to", "what", "which", "why",
    }
)  # fmt: skip
_EXTREMES = frozenset({"min", "max", "ref"})
"""Parts of a name that hardly change what it means."""
_SAME, _PLURAL, _SYNONYM, _TYPO = 1.0, 0.97, 0.93, 0.9
_MEANING = 0.85
"""Factors of a match: with the same word, its plural, a synonym, a word of similar letters; and
with a word of the meaning instead of the name."""
_ORDER = 0.001
"""Deduction for each place in a line of synonyms."""
_EXTRA, _MOST_EXTRA = 0.015, 0.1
"""Deduction for each further part of the name, and the largest deduction."""
_ALIKE, _SLIP = 0.75, 0.85
"""Least similarity of two words that may be the same word with a slip: of a name, of a synonym."""


def fold(word: str) -> str:
    """A word as names are written: lower case, ``_`` for spaces and hyphens.

    >>> fold(" Natural frequency")
    'natural_frequency'
    """
    return re.sub(r"[\s-]+", "_", word.strip().casefold())


@lru_cache(maxsize=1 << 12)
def tokens(text: str) -> tuple[str, ...]:
    """The words of a text or name in lower case, without articles and the like.

    >>> tokens("axial stiffness of the rod"), tokens("rod.outer_diameter")
    (('axial', 'stiffness', 'rod'), ('rod', 'outer', 'diameter'))
    """
    words = re.findall(r"[^\W_]+", text.casefold())
    return tuple(word for word in words if word not in _STOP)


@cache
def _lines() -> Mapping[str, Mapping[int, int]]:
    """For each word, its place in every line of `SYNONYMS` that contains it, by line."""
    lines: dict[str, dict[int, int]] = {}
    for number, line in enumerate(SYNONYMS.strip().splitlines()):
        for place, word in enumerate(line.split()):
            lines.setdefault(word, {})[number] = place
    return lines


def _synonym(word: str, other: str) -> float:
    """Match of two words as synonyms, from 0 to 1; 0 if they are none."""
    first = _lines_of(word) or _lines_of(_corrected(word))
    second = _lines_of(other)
    places = [place for line, place in second.items() if line in first]
    return _SYNONYM - _ORDER * min(places) if places else 0.0


def _lines_of(word: str) -> Mapping[int, int]:
    """Lines of synonyms that contain a word or its singular, with its place in them."""
    known = _lines()
    return known.get(word) or known.get(_singular(word)) or {}


def usual(word: str) -> str | None:
    """The word of design files for a synonym; None if there is none, or more than one.

    >>> usual("weight"), usual("gland"), usual("mass")
    ('mass', 'head', None)
    """
    lines = SYNONYMS.strip().splitlines()
    first = {lines[number].split()[0] for number in _lines_of(word.strip().casefold())}
    return first.pop() if len(first) == 1 and first != {word} else None


@lru_cache(maxsize=1 << 10)
def _corrected(word: str) -> str:
    """The word of `SYNONYMS` that a long word almost equals, or the word itself."""
    if len(word) < 5 or _lines_of(word):
        return word
    score, best = max((_similarity(word, other, _SLIP), other) for other in _lines())
    return best if score else word


def _singular(word: str) -> str:
    if len(word) > 4 and word.endswith("ies"):
        return f"{word[:-3]}y"
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word


def _similarity(first: str, second: str, least: float) -> float:
    """Share of common letters of two texts, in their order; 0 if it is less than `least`."""
    import difflib  # slow to import, needed for faults only

    matcher = difflib.SequenceMatcher(None, second, first)
    if matcher.real_quick_ratio() < least or matcher.quick_ratio() < least:
        return 0.0
    ratio = matcher.ratio()
    return ratio if ratio >= least else 0.0


@lru_cache(maxsize=1 << 14)
def _match(word: str, other: str, *, spelled: bool) -> float:
    """Match of two single words, from 0 to 1; with `spelled`, slips of the pen count too."""
    if word == other:
        return _SAME
    if _singular(word) == _singular(other):
        return _PLURAL
    if synonym := _synonym(word, other):
        return synonym
    short, long = sorted((word, other), key=len)
    if len(short) >= 4 and long.startswith(short):
        return 0.6 + 0.35 * len(short) / len(long)
    if not spelled or len(short) < 4:
        return 0.0
    return _TYPO * _similarity(word, other, _ALIKE)


@lru_cache(maxsize=1 << 14)
def _forms(word: str) -> frozenset[str]:
    """Singular, first four letters and lines of synonyms of a word: matches share one of them."""
    singular = _singular(word)
    lines = {**_lines_of(_corrected(word)), **_lines_of(word), **_lines().get(singular, {})}
    return frozenset({singular, f"{word[:4]}*", *map(str, lines)})


@lru_cache(maxsize=1 << 12)
def _forms_of(text: str) -> frozenset[str]:
    """The forms of all words of a text."""
    return frozenset().union(*map(_forms, tokens(text)))


def _by_words(words: tuple[str, ...], name: str, meaning: str) -> float:
    """Mean match of the words with a name and its meaning, less a little for further parts."""
    parts, about = tokens(name), tokens(meaning)
    if not words or not parts:
        return 0.0
    forms = _forms_of(meaning)
    total, used = 0.0, set()
    for word in words:
        best, at = max(
            ((_match(word, part, spelled=True), k) for k, part in enumerate(parts)),
            key=lambda pair: pair[0],
        )
        if best > 0:
            used.add(at)
        meant = 0.0
        if not _forms(word).isdisjoint(forms):
            meant = max((_match(word, other, spelled=False) for other in about), default=0.0)
        total += max(best, _MEANING * meant)
    extra = sum(
        _EXTRA / 3 if part in _EXTREMES else _EXTRA for k, part in enumerate(parts) if k not in used
    )
    return total / len(words) - min(extra, _MOST_EXTRA)


def meaning_of(declared: object) -> str:
    """Meaning of a declared thing in words: its label, or its help; a text is the meaning itself.

    >>> meaning_of("bore diameter"), meaning_of(None)
    ('bore diameter', '')
    """
    if isinstance(declared, str):
        return declared
    texts = (getattr(declared, name, "") for name in ("label", "title", "help"))
    return " ".join(text for text in texts if isinstance(text, str) and text)


def ranked(
    word: str, names: Iterable[str] | Mapping[str, object], least: float = 0.6
) -> list[tuple[float, str, bool]]:
    """Near names with their score, best first: (score, name, whether by letters alone).

    The score is the larger one of two: the similarity of the letters, of the whole name or of the
    last key of a PATH; and how well the single words match those of the name, by letters, synonym
    or meaning. Names of equal score keep their order.

    Parameters
    ----------
    word : what a user wrote
    names : the names; in a mapping, each with its declaration, whose label or help is the meaning
    least : smallest score of a near name
    """
    folded = fold(word)
    if not folded or len(word) > LONGEST:
        return []
    words = tokens(folded)
    found = []
    for name in names:
        other = fold(name)
        if other == folded:
            found.append((2.0, name, True))
            continue
        letters = _similarity(folded, other, least)
        last = other.rpartition(".")[2]
        if last != other and "." not in folded:
            letters = max(letters, 0.99 if last == folded else _similarity(folded, last, least))
        meaning = meaning_of(names[name]) if isinstance(names, Mapping) else ""
        score = _by_words(words, name, meaning)
        if max(letters, score) >= least:
            found.append((max(letters, score), name, letters >= score))
    return sorted(found, key=lambda entry: -entry[0])


def by_nearness(about: str, names: Iterable[str] | Mapping[str, object]) -> list[str]:
    """All names, those that match one of some words first.

    Parameters
    ----------
    about : words, such as the last two keys of the PATH that takes the name
    names : as for `ranked`

    >>> by_nearness("piston.back_up_material", ["guide_pom", "back_up_ptfe"])
    ['back_up_ptfe', 'guide_pom']
    """

    def match(name: str) -> float:
        meaning = meaning_of(names[name]) if isinstance(names, Mapping) else ""
        best = max((_by_words((word,), name, meaning) for word in words), default=0.0)
        return best if best >= _ALIKE else 0.0

    words = tokens(".".join(about.split(".")[-2:]))
    return sorted(names, key=lambda name: -match(name))


def nearest(word: str, names: Iterable[str] | Mapping[str, object], count: int = 3) -> list[str]:
    """The nearest names, best first; parameters as for `ranked`.

    >>> nearest("weight", ["stiffness_min", "mass", "mass_oil"], 1)
    ['mass']
    >>> nearest("bore", ["cylinder.bore", "rod.outer_diameter"])
    ['cylinder.bore']
    """
    exact = [name for name in names if fold(name) == fold(word)]
    return exact[:count] if len(exact) >= count else [x for _, x, _ in ranked(word, names)[:count]]
