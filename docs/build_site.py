#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the documentation's site.

usage: build_site.py PROGRAM FOLDER; the page to open is FOLDER/site/index.html

The pages are those of docs/, the algorithms' READMEs, and a page for each kind of YAML file,
generated from the schemas that PROGRAM prints. Exits with 77 (skipped) without mkdocs.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ALGORITHMS = ("kiss_icp", "kiss_icp_head", "ct_icp", "fast_lio2", "lio_sam", "arena_lo", "arena_lio")


def limits(field):
    if "enum" in field:
        return ", ".join(field["enum"])
    if "anyOf" in field:
        return limits(field["anyOf"][0]) + ", or unset"
    if "type" not in field:
        return "any JSON value"
    if field["type"] == "array":
        count = f"{field['minItems']} of " if "minItems" in field else ""
        return "list of " + count + limits(field["items"])
    if field["type"] in ("number", "integer"):
        low, high = field.get("minimum"), field.get("maximum")
        bounds = [f"> {field['exclusiveMinimum']:g}"] if "exclusiveMinimum" in field else []
        bounds += [f">= {low:g}"] if low is not None else []
        bounds += [f"<= {high:g}"] if high is not None else []
        return " ".join([field["type"], *bounds])
    return {"object": "group", "boolean": "true or false", "string": "text"}[field["type"]]


def group_of(field):
    """The keys of a group, a list of groups or an optional group; None for other fields."""
    for inner in (field, field.get("items", {}), *field.get("anyOf", [])):
        if "properties" in inner:
            return inner["properties"]
    return None


def rows(properties, path=""):
    for key, field in properties.items():
        inner = group_of(field)
        default = "" if inner else json.dumps(field["default"])
        default = f"`{default}`" if 0 < len(default) < 60 else ""
        text = field.get("description", "").replace("|", "\\|")
        yield f"| `{path}{key}` | {limits(field)} | {default} | {text} |"
        if inner:
            yield from rows(inner, f"{path}{key}.")


def reference_page(document):
    return "\n".join([f"# {document['title']}", "", "| key | values | default | meaning |",
                      "|---|---|---|---|", *rows(document["properties"]), ""])


def write_reference(program, pages):
    subprocess.run([program, "schema", "--out", pages.parent / "schemas"], check=True)
    folder = pages / "reference"
    folder.mkdir()
    index = ["# All configuration keys", "",
             "Generated from the field lists that the program reads its files with. "
             "`lidarena schema KIND` prints the same as a JSON schema, for editors.", ""]
    for file in sorted((pages.parent / "schemas").glob("*.schema.json")):
        name = file.name.replace(".schema.json", "").replace("+", "_with_")
        document = json.loads(file.read_text())
        (folder / f"{name}.md").write_text(reference_page(document))
        index.append(f"- [{document['title']}]({name}.md)")
    (folder / "index.md").write_text("\n".join(index) + "\n")


def without_source_links(text):
    """`text` without its links to files of the source tree, which the site does not contain."""
    return re.sub(r"\[([^\]]+)\]\((?!https?:|#)[^)]+\)", r"\1", text)


def link_to_site_pages(page):
    """Changes links to an algorithm's README in the source tree to its page on the site."""
    text = page.read_text()
    page.write_text(re.sub(r"\.\./lidarena/odometry/(\w+)/README\.md", r"algorithms/\1.md", text))


def main():
    if shutil.which("mkdocs") is None:
        print("skipped: mkdocs not found")
        return 77
    program, out = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    for made in ("pages", "schemas", "site"):
        shutil.rmtree(out / made, ignore_errors=True)
    pages = out / "pages"
    shutil.copytree(ROOT / "docs", pages, ignore=shutil.ignore_patterns("*.py", "*.txt"))
    (pages / "algorithms").mkdir()
    for name in ALGORITHMS:
        readme = ROOT / "lidarena" / "odometry" / name / "README.md"
        (pages / "algorithms" / f"{name}.md").write_text(without_source_links(readme.read_text()))
    for page in pages.rglob("*.md"):
        link_to_site_pages(page)
    write_reference(program, pages)
    config = (ROOT / "mkdocs.yml").read_text()
    (out / "mkdocs.yml").write_text(config + f"\ndocs_dir: {pages}\nsite_dir: {out / 'site'}\n")
    return subprocess.run(["mkdocs", "build", "--strict", "-f",
                           out / "mkdocs.yml"]).returncode


if __name__ == "__main__":
    sys.exit(main())
