# SPDX-License-Identifier: GPL-2.0-or-later
"""A JSON file that holds one object, each key once."""

import json

from ..base.errors import SceneError

FORMAT = 1  # of scene.json and of what a dry run writes; the newest that is read


def read_object(path, wanted):
    """Key -> value, but for the key ``format``, which is 1 where it is missing; raises SceneError naming file and cause.

    wanted : what the file should hold, for the error
    """
    try:
        with open(path, encoding="utf-8") as handle:
            values = json.load(handle, object_pairs_hook=_without_repeats)
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise SceneError(f"{path}: not valid JSON ({error})") from error
    if not isinstance(values, dict):
        raise SceneError(f"{path}: wants an object with {wanted}")
    form = values.pop("format", FORMAT)
    if isinstance(form, bool) or not isinstance(form, int) or not 1 <= form <= FORMAT:
        raise SceneError(f"{path}: 'format' is {json.dumps(form)}, but {FORMAT} is the newest that is read here: was the file "
                         "written by a newer version?")
    return values


def _without_repeats(pairs):
    """A JSON object; raises ValueError for a key that stands there twice, of which JSON keeps the last."""
    values = dict(pairs)
    if len(values) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError("key '" + next(name for name in names if names.count(name) > 1) + "' stands there twice")
    return values
