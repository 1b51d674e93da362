"""What some files hold in place of their content: nothing, a pointer of a version control, a web page.

Source: the specifications of Git LFS (pointer file, version 1) and git-annex (annex pointer files).
"""

from __future__ import annotations

import re

STAND_INS = {
    rb"\s*\Z": "is empty",
    rb"version https://git-lfs\.github\.com/spec/": "is a Git LFS pointer ('git lfs pull' brings the file)",
    rb"/annex/objects/": "is a git-annex pointer ('git annex get' brings the file)",
    rb"(?i:\s*<(!doctype html|html\b))": "is a web page",
}


def placeholder(content: bytes) -> str:
    """What a file is whose content is missing, such as `is empty`; nothing where it seems to be there."""
    return next((what for begin, what in STAND_INS.items() if re.match(begin, content)), "")
