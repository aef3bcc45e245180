#!/usr/bin/python3
"""Checks that relative links and anchors in the tracked pages of Markdown lead to tracked files and to headings.

Usage: links.py [SOURCE_FOLDER]     Prints each broken link; exit code 1 if there are any.
"""
import bisect
import collections
import difflib
import pathlib
import posixpath
import re
import subprocess
import sys
import urllib.parse

NOT_RENDERED = re.compile(r"<!--.*?-->|^ {0,3}(```+|~~~+).*?^ {0,3}\1[`~]*[ \t]*$", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"(?<!`)(`+)(?!`)((?:[^\n]|\n(?!\s*\n))*?)(?<!`)\1(?!`)")
LINK = re.compile(r"""\]\(\s*<?([^()<>\s]*(?:\([^()\s]*\)[^()<>\s]*)*)>?(?:\s+(?:"[^"]*"|'[^']*'))?\s*\)"""
                  r"""|^ {0,3}\[[^\]\n]+\]:\s*<?([^<>\s]+)|<(?:a|img)\b[^>]*?\b(?:href|src)\s*=\s*["']([^"'>]*)""",
                  re.MULTILINE)
HEADING = re.compile(r"^ {0,3}#{1,6}[ \t]+(.*?)(?:[ \t]+#+)?[ \t]*$", re.MULTILINE)
NAMED = re.compile(r"""<[a-z]\w*\b[^>]*?\b(?:id|name)\s*=\s*["']([^"'>]+)""")
WITH_SCHEME = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.IGNORECASE)


def blank(match):
    """Spaces instead of the text, so that line numbers stay."""
    return re.sub(r"[^\n]", " ", match[0])


def anchor(heading):
    """The anchor that GitHub gives a heading: its text in lower case without punctuation, hyphens for spaces."""
    text = re.sub(r"!?\[([^\]]*)\](?:\([^)]*\)|\[[^\]]*\])", r"\1", heading)
    text = re.sub(r"<[^>]*>", "", text)
    plain = re.sub(r"(?<![\w`])_([^_`]+)_(?![\w`])", r"\1", text)
    return re.sub(r"[^\w\- ]", "", plain.strip().lower()).replace(" ", "-")


def anchors(text):
    seen = collections.Counter()
    found = set(NAMED.findall(CODE.sub(blank, text)))
    for heading in HEADING.findall(text):
        name = anchor(heading)
        found.add(f"{name}-{seen[name]}" if seen[name] else name)
        seen[name] += 1
    return found


def nearest(wanted, there):
    close = difflib.get_close_matches(wanted, there, 1, 0.5)
    return f": write {close[0]}?" if close else ""


def fault(page, target, pages, tracked):
    """What is wrong with a link of `page`, or None."""
    if WITH_SCHEME.match(target):
        return None
    path, _, fragment = urllib.parse.unquote(target).partition("#")
    path = path.partition("?")[0]
    file = page if not path else posixpath.normpath(
        path.lstrip("/") if path.startswith("/") else posixpath.join(posixpath.dirname(page), path))
    if file not in tracked:
        return f"no tracked file or folder {file}{nearest(file, tracked)}"
    if fragment and file in pages and fragment not in pages[file]:
        return f"{file} has no heading #{fragment}{nearest(fragment, pages[file])}"
    if fragment and file not in pages and not re.fullmatch(r"L\d+(?:-L\d+)?", fragment):
        return f"{file} is no page of Markdown and has no heading #{fragment}"
    return None


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True).stdout.decode()
    files = [name for name in listed.split("\0") if name and (root / name).exists()]
    tracked = {"."}.union(files, (str(folder) for name in files for folder in pathlib.PurePosixPath(name).parents))
    texts = {name: NOT_RENDERED.sub(blank, (root / name).read_text(encoding="utf-8"))
             for name in files if name.endswith(".md")}
    pages = {name: anchors(text) for name, text in texts.items()}
    read = 0
    broken = []
    for page, text in texts.items():
        ends = [match.start() for match in re.finditer("\n", text)]
        for link in LINK.finditer(CODE.sub(blank, text)):
            read += 1
            target = link[1] or link[2] or link[3] or ""
            wrong = fault(page, target, pages, tracked) if target else "the link has no target"
            if wrong:
                broken.append(f"{page}:{bisect.bisect_left(ends, link.start()) + 1}: {target}: {wrong}")
    print("\n".join(broken) or f"{read} links in {len(pages)} pages, all of them lead somewhere")
    return 1 if broken or not read else 0


if __name__ == "__main__":
    sys.exit(main())
