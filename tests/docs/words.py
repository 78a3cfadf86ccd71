#!/usr/bin/env python3
"""How the manual reads: at most MOST_WORDS words in the pages of docs/ as wc counts them, a README of at most MOST_LINES lines,
at most 25 words a sentence in the mean of every page and of the help texts, no sentence above 60, no idiom that a reader
with English as a second language looks up in vain, the standard terms, and no history of the code.
usage: words.py ROOT PROGRAM [PAGE...]    with pages: their longest sentences"""
import glob
import os
import re
import subprocess
import sys

MOST_WORDS, MOST_LINES, MEAN_SENTENCE, LONGEST_SENTENCE = 36000, 100, 25, 60
# What is refused, and what to write instead.
REFUSED = {
    r"hangs? on\b": "depends on", r"held against": "counted as a defect", r"\bdear(ly|er)?\b": "costly",
    r"under the hood|out of the box|on the fly|in a nutshell|rule of thumb|piece of cake": "plain words",
    r"\bso to speak\b|\bas it were\b|\blet alone\b|\bnot to mention\b": "nothing",
    r"\bboils? down\b": "is", r"\btill\b": "until", r"\bfor free\b": "without cost", r"\bnot not\b": "a positive sentence",
    r"\bweigh what they stand for\b": "plain words",
    r"\b(used to be|formerly|previously|was left out|in an earlier version)\b": "what holds now",
    r"\b(toll|stray|witness(es)?|sleepers?)\b": "penalty, deviation, sample point, wake threshold",
}


def prose(text):
    """Without code, headings, tables and the targets of links."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"^( {4}.*\n)+", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"`[^`]*`", "CODE", text)


def sentences(text):
    text = re.sub(r"^(#|\|).*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"^\s*([-*]|\d+\.) ", "\n\n", text, flags=re.MULTILINE)
    for paragraph in re.split(r"\n\s*\n", text):
        for sentence in re.split(r"(?<=[.!?:])[)*]*\s+", " ".join(paragraph.split())):
            count = len(re.findall(r"[A-Za-z][\w'-]*", sentence))
            if count > 2:
                yield count, sentence


def help_texts(program):
    """By verb: the description and what stands behind each option."""
    overview = subprocess.run([program, "help"], stdout=subprocess.PIPE, text=True, check=True).stdout
    for verb in re.findall(r"^  (\w+) ", overview, re.MULTILINE):
        text = subprocess.run([program, "help", verb], stdout=subprocess.PIPE, text=True, check=True).stdout
        text = text.split("\nexamples:")[0]
        yield f"scree help {verb}", re.sub(r"^  +(-\w, )?--\S+( [A-Z0-9:|/.=]+)?", "\n\n", text, flags=re.MULTILINE)


def judge(name, text, wrong):
    found = list(sentences(text))
    total = sum(count for count, _ in found)
    if found and total > MEAN_SENTENCE * len(found):
        wrong.append(f"{name}: {total / len(found):.1f} words a sentence")
    wrong.extend(f"{name}: {count} words: {sentence[:90]}..." for count, sentence in found if count > LONGEST_SENTENCE)
    for pattern, instead in REFUSED.items():
        wrong.extend(f"{name}: '{m[0]}': write {instead}" for m in re.finditer(pattern, text, re.IGNORECASE))
    return total, len(found)


def main(root, program, *pages):
    os.chdir(root)
    wrong, words, told, count = [], 0, 0, 0
    files = pages or sorted(glob.glob("docs/**/*.md", recursive=True)) + ["README.md", "CONTRIBUTING.md"]
    for name in files:
        with open(name, encoding="utf-8") as file:
            whole = file.read()
        text = prose(whole)
        total, number = judge(name, text, wrong)
        told, count = told + total, count + number
        if name.startswith("docs/"):
            words += len(whole.split())
        elif name == "README.md" and whole.count("\n") > MOST_LINES:
            wrong.append(f"README.md: more than {MOST_LINES} lines")
        if pages:
            print(*(f"{n:4} {s}" for n, s in sorted(sentences(text), reverse=True)[:25]), sep="\n")
    for name, text in help_texts(program):
        judge(name, re.sub(r"`[^`]*`", "CODE", text), wrong)
    if words > MOST_WORDS:
        wrong.append(f"{words} words in docs/, more than {MOST_WORDS}")
    print("\n".join(wrong) or f"{words} words in docs/, {told / count:.1f} a sentence in {len(files)} pages")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
