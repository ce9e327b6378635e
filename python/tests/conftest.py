"""What the tests fly."""

from __future__ import annotations

from typing import Any

import pytest

SHORT: dict[str, Any] = {
    "mission": [
        {"do": "arm"},
        {"do": "takeoff", "altitude": 3.0},
        {"do": "hold", "seconds": 4.0},
        {"do": "land"},
    ]
}


@pytest.fixture
def short() -> dict[str, Any]:
    """Take off to 3 m, hold four seconds, land."""
    return SHORT
