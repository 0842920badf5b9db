"""Every key that a scene may have, found in the models themselves; values put there, and what a refusal must look like."""

import copy
import re
import types
import typing

from pydantic import BaseModel

from melt.errors import MeltError

#: What no user should read: words of Python and of its libraries.
JARGON = re.compile(
    r"Traceback|pydantic|validation error|Input should|object has no|NoneType|ndarray|numpy|dtype|_type\b|<class|np\.float|"
    r"unhashable|not subscriptable|broadcast|internal error", re.I,
)


def keys_of(model, path=()):
    """Yield the path of every key of a model and of its sections (tables of a list at 0)."""
    for name, field in model.model_fields.items():
        here = (*path, name)
        yield here
        inner, listed = _section(field.annotation)
        if inner is not None:
            yield from keys_of(inner, (*here, 0) if listed else here)


def _section(annotation, listed=False):
    """Return the model in an annotation, and whether it stands in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation, listed
    for inner in typing.get_args(annotation):
        if inner is not types.NoneType:
            found = _section(inner, listed or typing.get_origin(annotation) is list)
            if found[0] is not None:
                return found
    return None, False


def put(scene, path, value):
    """Return a copy of a scene with a value at a path; sections on the way are made."""
    scene = copy.deepcopy(scene)
    at = scene
    for key, following in zip(path, path[1:]):
        if isinstance(key, int):
            while len(at) <= key:
                at.append({})
            at = at[key]
        else:
            kind = list if isinstance(following, int) else dict
            if not isinstance(at.get(key), kind):
                at[key] = kind()
            at = at[key]
    at[path[-1]] = value
    return scene


def in_words(error, *said):
    """Hold that an error is melt's, one paragraph without jargon that says all of ``said``."""
    text = str(error)
    assert isinstance(error, MeltError), repr(error)
    assert text and "\n" not in text.strip(), text
    assert not JARGON.search(text), text
    for words in said:
        assert words in text, f"{words!r} is not in: {text}"
