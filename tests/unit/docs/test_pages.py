"""What the documents point at is there: links, headings, files, modules, commands and settings."""

import re
from pathlib import Path

import pytest

from cliffscan.cli import build_parser
from cliffscan.configuration_page import page as configuration_page
from cliffscan.run import service_names

TOP = Path(__file__).parents[3]
PAGES = [*TOP.glob("*.md"), *(TOP / "docs").glob("*.md"), TOP / "common/README.md"]
CODE = re.compile(r"```.*?```|`[^`\n]+`", re.DOTALL)
FOLDERS = [init.parent.name for init in TOP.glob("*/__init__.py")]


@pytest.fixture(params=PAGES, ids=[str(page.relative_to(TOP)) for page in PAGES])
def page(request):
    return request.param


def code(page):
    """All that is set as code, inline and in blocks."""
    return "\n".join(CODE.findall(page.read_text("utf-8")))


def anchors(page):
    """The headings of a page as a link names them."""
    prose = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.+)$", prose, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_relative_links_resolve(page):
    links = re.findall(r"\]\((?!https?:)([^)#\s]*)#?([^)\s]*)\)", CODE.sub("", page.read_text("utf-8")))
    for path, anchor in links:
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), path
        assert not anchor or anchor in anchors(target), f"{path}#{anchor}"


def test_modules_that_are_run_exist(page):
    for name in re.findall(r"python3? -m ([a-z_]+(?:\.[a-z_]+)*)\b(?!\.)", code(page)):
        path = TOP / name.replace(".", "/")
        if name.split(".")[0] in FOLDERS:
            assert (path / "__main__.py").exists() or path.with_suffix(".py").exists(), name


def test_files_that_are_named_exist(page):
    names = re.findall(r"(?<![\w./*-])((?:[\w-]+/)*\w+\.py)\b(?!:)", code(page))
    files = [str(file.relative_to(TOP)) for folder in FOLDERS for file in (TOP / folder).rglob("*.py")]
    unknown = [name for name in names if not any(f"/{file}".endswith(f"/{name}") for file in files)]
    assert [name for name in unknown if not name.startswith("my_")] == []


def test_commands_exist(page):
    commands = next(action.choices for action in build_parser()._actions if action.choices)
    for name, word in re.findall(r"(?:^|`|/bin/)cliffscan ([a-z][a-z-]*)(?: ([a-z]+)\b)?", code(page), re.MULTILINE):
        assert name in commands
        assert name != "run" or not word or word in service_names()


def test_settings_exist(page):
    if page.name == "CHANGELOG.md":
        return  # it names settings of the past
    services = "|".join(service_names())
    known = set(re.findall(rf"^\| `((?:{services})\.[\w.]+)`", configuration_page(), re.MULTILINE))
    assert known
    for name in re.findall(rf"(?<![\w./])((?:{services})\.[a-z_]+)\b(?!\()", code(page)):
        table = any(each.startswith(f"{name}.") for each in known)
        assert name in known or table or name.endswith((".py", ".md")), name


def figures(page):
    """Scan and figures of each row of an accuracy table, without their bold face."""
    rows = [[cell.strip(" *`") for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("|")]
    return [tuple(row[1:6]) for row in rows if len(row) >= 6]


def test_the_readme_has_the_accuracy_of_the_results():
    readme, results = (figures((TOP / page).read_text()) for page in ("README.md", "docs/results.md"))
    assert ("the paper's, combined", "85.8 %", "14.2 %", "100 %", "22.5 cm") in readme
    assert set(readme) <= set(results)
