"""Validation errors in words: key, value, what is allowed, remedy."""

import difflib
import types
import typing

from pydantic import BaseModel

_SHOWN = 5


def explain(error, data, title, model):
    """Return a pydantic ``ValidationError`` of ``data`` against ``model`` as one paragraph."""
    found = {}
    for item in error.errors(include_url=False):
        path = _path(item["loc"], data)
        if item["type"] in ("extra_forbidden", "missing"):
            path = tuple(k for k in item["loc"])
        found.setdefault(path, []).append(item)
    parts = [_sentence(path, items, model) for path, items in found.items()]
    more = f"; and {len(parts) - _SHOWN} more" if len(parts) > _SHOWN else ""
    return f"{title}: " + "; ".join(parts[:_SHOWN]) + more


def _path(location, data):
    """Cut from ``location`` what is not in the data (pydantic adds the branch of a union)."""
    path = []
    for key in location:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            break
        path.append(key)
    return tuple(path)


def _sentence(path, items, model):
    name = ".".join(str(k) for k in path)
    first = items[0]
    if first["type"] == "extra_forbidden":
        known = list(_model_at(model, path[:-1]).model_fields)
        close = difflib.get_close_matches(str(path[-1]), known, 1)
        hint = f"did you mean {close[0]!r}?" if close else f"known keys here: {', '.join(known)}"
        return f"{name} is not a known key; {hint}"
    if first["type"] == "missing":
        return f"{name} is required and missing"
    texts = list(dict.fromkeys(_allowed(item) for item in items))
    if first["type"] == "value_error" and len(items) == 1:
        return f"{name}: {texts[0]}" if name else texts[0]
    return f"{name} = {first['input']!r} is not allowed: it must be {' or '.join(texts)}"


def _allowed(item):
    kind, context = item["type"], item.get("ctx", {})
    if kind == "value_error":
        return str(context["error"])
    for test, word in (("gt", "greater than"), ("ge", "at least"), ("lt", "less than"), ("le", "at most")):
        if test in context:
            return f"{word} {context[test]:g}"
    if kind in ("literal_error", "enum"):
        return context["expected"].replace("'", "")
    if kind in ("too_short", "too_long"):
        count = context.get("min_length", context.get("max_length"))
        return f"a list of {count} values"
    plain = {
        "int_type": "a whole number", "int_parsing": "a whole number", "int_from_float": "a whole number",
        "int_parsing_size": "a whole number", "finite_number": "a whole number", "tuple_type": "a list",
        "bool_type": "true or false", "bool_parsing": "true or false", "string_type": "text",
        "list_type": "a list", "model_type": "a table", "dict_type": "a table",
        "model_attributes_type": "a table",
    }
    return plain.get(kind, item["msg"].removeprefix("Input should be "))


def _model_at(model, path):
    """Return the section model that ``path`` leads to."""
    for key in path:
        if key not in model.model_fields:  # a number in a list, or the branch of a union
            continue
        model = _section(model.model_fields[key].annotation)
    return model


def _section(annotation):
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in typing.get_args(annotation):
        if inner is not types.NoneType and (found := _section(inner)) is not None:
            return found
    return None
