"""Parts of the pages in docs/ that a program writes: the text between two marks, each a comment."""

import sys

BEGIN, END = "<!-- %s: begin, written by %s -->", "<!-- %s: end -->"


def replaced(page, text, block, command, content):
    """`text` of `page` with `content` between the marks of `block`, which `command` writes. Ends the program if they
    are missing."""
    begin, end = BEGIN % (block, command), END % block
    if begin not in text or end not in text:
        sys.exit("%s: the lines «%s» and «%s» are not there: put them back around what they mark" % (page, begin, end))
    head, rest = text.split(begin, 1)
    return "%s%s\n%s%s%s" % (head, begin, content, end, rest.split(end, 1)[1])
