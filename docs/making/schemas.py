"""The JSON Schemas of the documents that imuwb writes, as files to download and as tables of their keys."""

import json
from pathlib import Path
from typing import Any

from imuwb.schemas import schema, schema_names
from making.markdown import cell, table

ABOUT = """\
A schema (JSON Schema, draft 2020-12) is made from the types and tables that write the document, at each build of these pages, so it describes what this
version of imuwb writes, and every key. TOML is read as JSON: `python -c "import tomllib, json, sys; json.dump(tomllib.load(sys.stdin.buffer), sys.stdout)"`.
Parquet tables of a fleet are described in [the page of fleets](../../how-to/fleet).

A document has the number of its `schema`. A change that takes a key away, or changes its meaning, raises the number; a new key does not. A program that
wants to read the documents of later versions too ignores the keys that it does not know.

From Python, `imuwb.schemas.schema("error-model")` returns one, also of an analysis of another package:

```python
from imuwb.schemas import schema, schema_names

print(schema_names())
print(schema("analysis-psd")["title"])
```
"""


def make(folder: Path) -> None:
    """Write the file of each schema, and the page that lists them."""
    parts = ["(schemas)=", "# Schemas of documents", ABOUT]
    for name in schema_names():
        content = schema(name)
        (folder / f"{name}.schema.json").write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")
        parts += [
            f"(schema-{name})=",
            f"## {name}",
            f"{content['title']}: {{download}}`{name}.schema.json <{name}.schema.json>`.",
            _keys(content),
        ]
    (folder / "index.md").write_text("\n\n".join(parts) + "\n", "utf-8")


def _keys(content: dict[str, Any]) -> str:
    """Return a table of the keys of a document and of its result; the file has all others."""
    own: dict[str, Any] = content.get("properties", {})
    if not own:
        commands = [one["title"] for one in content.get("oneOf", ())]
        return f"One form for each command: {', '.join(f'`{name}`' for name in commands)}."
    required = content.get("required", ())
    rows = [(f"`{name}`", _kind(part, content), "always" if name in required else "") for name, part in own.items()]
    return table(("key", "value", "there"), rows)


def _kind(part: dict[str, Any], whole: dict[str, Any]) -> str:  # noqa: PLR0911 - one return for each kind of value
    """Return what a value is, in a few words."""
    if "const" in part:
        return f"`{json.dumps(part['const'])}`"
    if "enum" in part:
        return " or ".join(f"`{one}`" for one in part["enum"])
    if "$ref" in part:
        name = part["$ref"].rpartition("/")[2]
        return cell(whole["$defs"][name].get("description", "").rstrip(".")) or name
    if "anyOf" in part:
        return " or ".join(dict.fromkeys(_kind(one, whole) for one in part["anyOf"]))
    if part.get("type") == "array":
        inner = part.get("items", {})
        return f"list: {_kind(inner, whole)}" if inner else "list"
    if part.get("type") == "object":
        inner = part.get("additionalProperties")
        return f"table: {_kind(inner, whole)}" if isinstance(inner, dict) and inner else "table"
    kind = part.get("type", "any value")
    return " or ".join(kind) if isinstance(kind, list) else str(kind)
