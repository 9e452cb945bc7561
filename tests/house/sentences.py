#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the length of each document, and the median and the 90th percentile of the words per
sentence. Exit code 1 if a document exceeds its limits.

usage: sentences.py [ROOT]

Prose and items of lists are read; code, tables, headings and HTML comments are not. A word is
what stands between blanks and contains a letter or a digit; a piece of inline code or a link
counts as the text that is shown. Colons and semicolons do not end a sentence.
"""
import math
import pathlib
import re
import statistics
import sys

# document: (words as `wc -w` counts them, median, 90th percentile). A document that became plainer
# gets lower limits; none gets higher ones. Decisions have those
# of DECISION; what is not listed has those of ELSE.
LIMITS = {
    "README.md": (600, 15, 25),
    "docs/first-scene.md": (1600, 15, 25),
    "docs/overview.md": (2500, 15, 25),
    "docs/python-examples.md": (1000, 15, 25),
    "docs/python.md": (2200, 15, 25),
    "docs/scene-format.md": (math.inf, 15, 25),
    "docs/sdk.md": (math.inf, 15, 25),
    "docs/write_a_model.md": (1600, 15, 25),
}
DECISION = (600, 18, 27)  # a page
ELSE = (math.inf, 24, 37)


def limits_of(name):
    return LIMITS.get(name, DECISION if name.startswith("docs/decisions/") else ELSE)


def prose(text):
    """The text as paragraphs without markup; items of lists are paragraphs of their own."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    text = re.sub(r"^( {4}.*|#.*|\|.*|<.*|!\[.*)$", "", text, flags=re.M)
    text = re.sub(r"^ *([-*]|\d+\.) ", "\n", text, flags=re.M)
    text = re.sub(r"`[^`]*`", "code", text)
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text)
    return [" ".join(part.split()) for part in re.split(r"\n\s*\n", text)]


def sentence_lengths(text):
    """The number of words of each sentence."""
    for paragraph in prose(text):
        shielded = re.sub(r"\b(e\.g|i\.e|cf|vs|Fig|No|[A-Z])\.", r"\1", paragraph)
        for sentence in re.split(r"(?<=[.!?])[\"')*]*\s+(?=[\"'(*]*[A-Z0-9])", shielded):
            if words := sum(bool(re.search(r"\w", word)) for word in sentence.split()):
                yield words


def percentile_90(numbers):
    return sorted(numbers)[math.ceil(0.9 * len(numbers)) - 1]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
    files = [root / "README.md", *sorted(root.glob("docs/*.md")), *sorted(root.glob("docs/decisions/*.md"))]
    too_long = False
    print(f"{'document':50} {'words':>6} {'sentences':>9} {'median':>6} {'p90':>4}")
    for file in files:
        text, name = file.read_text(encoding="utf-8"), str(file.relative_to(root))
        counts = list(sentence_lengths(text)) or [0]
        found = (len(text.split()), statistics.median(counts), percentile_90(counts))
        excess = [f"at most {most:g} {what}" for value, most, what in
                  zip(found, limits_of(name), ("words", "in the median", "in p90")) if value > most]
        print(f"{name:50} {found[0]:6} {len(counts):9} {found[1]:6g} {found[2]:4} {'; '.join(excess)}")
        too_long |= bool(excess)
    return too_long


if __name__ == "__main__":
    sys.exit(main())
