# SPDX-License-Identifier: Apache-2.0
"""One list of blocks, written as index.html and as README.md, so that nothing is said twice.

Text may hold `code` and **bold**; everything else is taken as it stands.
"""

import html
import re
from dataclasses import dataclass

STYLE = """body { font: 16px/1.5 sans-serif; max-width: 72em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: .2em .8em; border-bottom: 1px solid #ccc; text-align: right; }
th:first-child, td:first-child { text-align: left; } caption { text-align: left; padding: .3em 0; color: #555; }
figure { margin: 1.5em 0; } figure img { max-width: 100%; } figure.row img { max-width: 32%; } figcaption { color: #555; }
code { background: #f3f3f3; }"""


@dataclass
class Heading:
    level: int
    text: str


@dataclass
class Paragraph:
    text: str


@dataclass
class Table:
    head: list
    rows: list  # of lists of str, as long as the head
    caption: str = ""


@dataclass
class Figure:
    files: list  # names relative to the page
    caption: str


def html_text(text):
    text = html.escape(text, quote=False)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    return re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", text)


def html_block(block):
    if isinstance(block, Heading):
        return f"<h{block.level}>{html_text(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f"<p>{html_text(block.text)}</p>"
    if isinstance(block, Figure):
        images = "".join(f'<img src="{html.escape(name)}" alt="{html.escape(alternative(block))}">' for name in block.files)
        row = ' class="row"' if len(block.files) > 1 else ""
        return f"<figure{row}>{images}<figcaption>{html_text(block.caption)}</figcaption></figure>"
    row_html = lambda tag, cells: "<tr>" + "".join(f"<{tag}>{html_text(cell)}</{tag}>" for cell in cells) + "</tr>"
    caption = f"<caption>{html_text(block.caption)}</caption>" if block.caption else ""
    rows = "\n".join(row_html("td", row) for row in block.rows)
    return f"<table>{caption}\n{row_html('th', block.head)}\n{rows}\n</table>"


def markdown_text(text):
    """HTML's and Markdown's own signs lose their meaning, but for `code` and **bold**."""
    parts = re.split(r"(`[^`]+`|\*\*)", text)
    signs = r"([\\<>*\[\]#]|(?<!\w)_|_(?!\w))"  # a line between letters is only a line
    return "".join(part if part.startswith("`") or part == "**" else re.sub(signs, r"\\\1", part) for part in parts)


def alternative(figure):
    """A few words for those who do not see the pictures; the caption follows anyway."""
    return re.split(r"[:(.]", figure.caption)[0].strip()


def markdown_block(block):
    if isinstance(block, Heading):
        return "#" * block.level + " " + markdown_text(block.text)
    if isinstance(block, Paragraph):
        return markdown_text(block.text)
    if isinstance(block, Figure):
        images = " ".join(f"![{markdown_text(alternative(block))}]({name})" for name in block.files)
        return images + "\n\n" + markdown_text(block.caption)
    row = lambda cells: "| " + " | ".join(markdown_text(cell).replace("|", "\\|") for cell in cells) + " |"
    rule = "|---|" + "---:|" * (len(block.head) - 1)
    caption = [markdown_text(block.caption), ""] if block.caption else []
    return "\n".join([*caption, row(block.head), rule, *map(row, block.rows)])


def to_html(blocks, title):
    body = "\n".join(html_block(block) for block in blocks)
    return (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>\n'
            f"<style>\n{STYLE}\n</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n")


def to_markdown(blocks):
    return "\n\n".join(markdown_block(block) for block in blocks) + "\n"


def write(blocks, folder, title):
    (folder / "index.html").write_text(to_html(blocks, title))
    (folder / "README.md").write_text(to_markdown(blocks))
