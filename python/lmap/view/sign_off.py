"""The verdict that only a person can give: somebody has looked at the drawing of this very model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lmap.spec.model import SignOff
from lmap.verdict import CriterionVerdict, Outcome
from lmap.view.model import Model

NAME = "a person has looked at the drawing"

LOOK_AT = (
    "from the front, the side, above and at an angle: every body and connection in its place, of its size and on the "
    "right bodies; values on hovering; wheels on the rails"
)


def verdict(
    model: Model, sign_off: SignOff | None, *, index: int, vehicle: str, settings: Mapping[str, Any]
) -> CriterionVerdict:
    """Passes where the spec carries a sign-off for this model, else waits for one.

    `vehicle` and `settings` are how the command line would name it.
    """
    signed = sign_off is not None and sign_off.model == model.hash
    return CriterionVerdict(
        index=index,
        name=NAME,
        case=model.condition or model.name,
        case_hash=model.hash,
        signals=(),
        signal=None,
        chain=(),
        value=None,
        unit="1",
        limit="a sign-off",
        bounds=(),
        margin=None,
        margin_percent=None,
        judged=True,
        outcome=Outcome.PASS if signed else Outcome.MANUAL,
        source="LMAP 1.2",
        message=_message(model, sign_off, vehicle, settings),
    )


def _message(model: Model, sign_off: SignOff | None, vehicle: str, settings: Mapping[str, Any]) -> str:
    if sign_off is not None and sign_off.model == model.hash:
        return f"signed by {sign_off.name} on {sign_off.date}"
    why = "nobody has signed yet"
    if sign_off is not None:
        why = (
            f"the sign-off of {sign_off.name} ({sign_off.date}) is void: it is for model {sign_off.model[:12]}..., "
            f"and the vehicle is {model.hash[:12]}... now"
        )
    options = [f" --condition {model.condition}" if model.condition else ""]
    options += [f" --set {key}={value}" for key, value in settings.items()]
    return (
        f"{why}. Open the drawing in the report folder (--report DIR), or the one that this makes:\n"
        f"    lmap view {vehicle}{''.join(options)}\n"
        f"Look {LOOK_AT}. If all of it is right, these lines at the end of the spec say so, in place of an older "
        "sign-off:\n"
        "    [sign_off]\n"
        '    name = "YOUR NAME"\n'
        '    date = "YYYY-MM-DD"\n'
        f'    model = "{model.hash}"'
    )
