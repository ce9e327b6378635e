"""A client's calls one after another, each with a time limit; what came of them."""

import asyncio
import re
import time

# Longer than what the clients themselves wait for one answer.
LIMIT = 10.0
DONE = "DONE"
HUNG = "HUNG"


async def first(stream, condition=lambda item: True):
    async for item in stream:
        if condition(item):
            return item


async def last(stream):
    item = None
    async for item in stream:
        pass
    return item


def reason(error):
    """The result's name, which both generations of MAVSDK write into their errors."""
    named = re.search(r"\b[A-Z][A-Z_]{2,}\b", str(error))
    return named.group() if named else f"{type(error).__name__}: {error}"


async def outcome(call):
    """`DONE`, the name of a refusal, or `HUNG`."""
    try:
        await asyncio.wait_for(call, LIMIT)
    except asyncio.TimeoutError:
        return HUNG
    except Exception as error:
        return reason(error)
    return DONE


async def outcomes(table, drone):
    """Of a table of names, calls and what is expected of them."""
    found = {}
    for name, call, _ in table:
        begin = time.monotonic()
        found[name] = await outcome(call(drone))
        print(f"{time.monotonic() - begin:5.2f} s  {name}: {found[name]}")
    return found
