# SPDX-License-Identifier: GPL-2.0-or-later
"""Checks that every internal link of a built site leads to a file and, after a #, to a place in it.

    check_links.py FOLDER
"""

import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    """What a page links to, and the places that others can link to."""

    def __init__(self, path):
        super().__init__()
        self.links, self.places = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name in ("id", "name") and value:
                self.places.add(value)


def broken_links(folder):
    pages = {path.resolve(): Page(path) for path in sorted(folder.rglob("*.html"))}
    for path, page in pages.items():
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                yield path, link
            elif parts.fragment and target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].places:
                yield path, link


def main():
    folder = pathlib.Path(sys.argv[1])
    broken = list(broken_links(folder))
    for path, link in broken:
        print(f"check_links: {path.relative_to(folder.resolve())} links to {link}, which is not there", file=sys.stderr)
    if not any(folder.rglob("*.html")):
        sys.exit(f"check_links: no pages in {folder}")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
