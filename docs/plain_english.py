#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds long sentences and stilted words in README.md and docs/*.md.

usage: plain_english.py [FILE ...]    faults of the files (default: all pages); exits with 1 if any
       plain_english.py --count       words, sentences and words a sentence of each page

A fault is a sentence above 25 words, or an expression of EXPRESSIONS. docs/plain_english.txt lists the
exceptions, each with its reason; one that no page needs is a fault, too. Code, tables, headings, pictures
and link targets are no sentences. An item of a list is at least one sentence.
"""
import argparse
import pathlib
import re
import sys

DOCS = pathlib.Path(__file__).resolve().parent
ROOT = DOCS.parent
EXCEPTIONS = DOCS / "plain_english.txt"
MAX_WORDS = 25

# Private or stilted expressions, and what to write.
EXPRESSIONS = {
    r"(is|are|was|were|be|been|it|them|as) told": "reported, printed, given",
    r"tells?": "reports, prints, shows",
    r"told": "reported, given",
    r"stands?(?! still)": "is, are",
    r"stood": "was, were",
    r"lies beside|lie beside": "is in the same folder",
    r"beside": "next to, compared with, in addition to",
    r"besides": "also",
    r"is there|are there(?! any)": "arrives, exists",
    r"what is (there|said)": "name the thing",
    r"of (its|their|your|our|my) own(?= (and|or|with|in|around|that|which|by|to|is|are)|[^ \w]|$)":
        "its own, your own, separate",
    r"goes on|go on": "continues",
    r"is said|are said": "is reported",
    r"by hand(?!held)": "manually",
    r"falls? short": "fails, misses the limit",
    r"come into question": "are candidates",
    r"at hand": "available",
    r"as it stands": "unchanged",
    r"without such": "otherwise",
    r"thereby|therein|thereof|whereby|wherein|hereby": "by this, in it",
    r"as good as|as well as": "and, almost",
    r"says so|say at|say for|say about": "prints it, for example",
}

BLOCKS = re.compile(r"```.*?```|^<!-- table .*?<!-- end -->", re.DOTALL | re.MULTILINE)
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
ITEM = re.compile(r"\s*(?:[-*]|\d+\.)\s+")
NO_PARAGRAPH = re.compile(r"\s*(?:#|\||!\[|</?\w)")
ABBREVIATIONS = re.compile(r"\b(et al|e\.g|i\.e|vs|Fig|No|[A-Z])\.(?=\s)")
SENTENCE_END = re.compile(r"(?:(?<=[.!?])|(?<=[.!?][\"')]))\s+(?=[\"'(\[]*[A-Z0-9`])")


def without_code(text):
    """`text` without fenced and indented code, generated tables and comments."""
    text = COMMENT.sub("", BLOCKS.sub("", text))
    lines, after_blank, in_list = [], True, False
    for line in text.splitlines():
        in_list = in_list and (not line.strip() or line.startswith(" ")) or bool(ITEM.match(line))
        indented = line.startswith("    ") and not in_list
        lines.append("" if indented and after_blank else line)
        after_blank = not line.strip() or (indented and after_blank)
    return lines


def paragraphs(text):
    """The paragraphs and list items of a page, each on one line."""
    found, parts = [], []
    for line in without_code(text) + [""]:
        starts_item = ITEM.match(line)
        if not line.strip() or starts_item or NO_PARAGRAPH.match(line):
            found.append(" ".join(parts))
            parts = []
        if line.strip() and not NO_PARAGRAPH.match(line):
            parts.append(line[starts_item.end():] if starts_item else line.strip())
    return [paragraph for paragraph in found if paragraph]


def one_word(code):
    return "`" + (re.sub(r"[^\w.]+", "_", code[0]).strip("_.") or "code") + "`"


def plain(paragraph):
    """Without Markdown, but code, each piece of it as one word between backquotes: a link is its text."""
    paragraph = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", paragraph)
    paragraph = re.sub(r"`[^`]*`", one_word, paragraph)
    paragraph = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)
    return re.sub(r"\*+|(?<!\w)_|_(?!\w)", "", paragraph).strip()


def sentences(text):
    found = []
    for paragraph in paragraphs(text):
        whole = ABBREVIATIONS.sub(r"\1", plain(paragraph))
        found += [sentence.strip() for sentence in SENTENCE_END.split(whole) if sentence.strip()]
    return found


def words(sentence):
    return [word for word in sentence.split() if re.search(r"\w", word)]


def faults(text):
    """(sentence, what is wrong with it) of a page."""
    for sentence in sentences(text):
        count = len(words(sentence))
        if count > MAX_WORDS:
            yield sentence, f"{count} words"
        prose = re.sub(r"`[^`]*`", "``", sentence)
        for expression, better in EXPRESSIONS.items():
            if found := re.search(rf"\b(?:{expression})\b", prose, re.IGNORECASE):
                yield sentence, f"\"{found[0]}\": write {better}"


def exceptions(text):
    """[(page, part of the sentence, reason)] of lines `page | part of a sentence | reason`."""
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        row = tuple(part.strip() for part in line.split(" | "))
        if len(row) != 3 or not all(row):
            raise ValueError(f"line {number}: not `page | part of a sentence | reason`: {line}")
        rows.append(row)
    return rows


def check(pages, allowed):
    """Lines of faults of `pages` ({name: text}) that no exception covers, and of unused exceptions."""
    lines, used = [], set()
    for name, text in pages.items():
        for sentence, fault in faults(text):
            excepted = [row for row in allowed if row[0] == name and row[1] in sentence]
            used.update(excepted)
            if not excepted:
                lines.append(f"{name}: {fault}: {sentence}")
    lines += [f"plain_english.txt: no sentence of {row[0]} needs \"{row[1]}\""
              for row in allowed if row not in used and row[0] in pages]
    return lines


def counted(name, text):
    found = sentences(text)
    total = sum(len(words(sentence)) for sentence in found)
    longest = sum(len(words(sentence)) > MAX_WORDS for sentence in found)
    return (f"{name:28} {total:6} words {len(found):5} sentences {total / max(1, len(found)):6.1f} "
            f"words a sentence {longest:4} above {MAX_WORDS}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("files", type=pathlib.Path, nargs="*")
    parser.add_argument("--count", action="store_true")
    arguments = parser.parse_args()
    files = arguments.files or [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
    pages = {file.name: file.read_text() for file in files}
    if arguments.count:
        print(*(counted(name, text) for name, text in pages.items()), sep="\n")
        return 0
    found = check(pages, exceptions(EXCEPTIONS.read_text() if EXCEPTIONS.exists() else ""))
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
