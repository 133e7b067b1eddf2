"""A rough contact: a law on a straight baseline, or on none, fitted to the whole loading in milliseconds."""

from __future__ import annotations

import numpy as np

from palpate.recordings.blocks import Blocks
from palpate.recordings.contact_law import LOG_PRIOR, loads_of_laws

FEWEST_IN_AIR = 6  # points
LATER = 0.03  # of the way, chosen: contacts on trial lie half as far apart
MUCH_WORSE, WELL = 2.0, 0.003  # ratio of mean squares; share of the load's range within which a law alone fits well
BORNE = 0.35  # of the load's range, chosen: no baseline curves by so much
MOST_OF = 0.8  # of the way to a rough contact, chosen: where it is examined, short of an event at its end


def coarse(time: np.ndarray, load: np.ndarray, depth: np.ndarray, approach: bool) -> tuple[float, float]:
    """Return the contact with which a law on a straight baseline fits the loading best, and its mean squared residual.

    Without an approach the baseline is zero.

    Parameters
    ----------
    time, load, depth, approach
        As for `palpate.recordings.contact_search.Loading`; load and depth may have any unit.
    """
    blocks = Blocks.even(200, time, depth, load)
    end, start = float(blocks.depth.max()), float(depth.min())
    contacts = np.unique([*np.linspace(start, end, 60), *blocks.depth[::3]])
    contacts = contacts[contacts < start + 0.97 * (end - start)]
    laws = loads_of_laws(blocks.depth, contacts, end).reshape(len(blocks.load), -1)
    straight = np.linalg.qr(np.column_stack([np.ones_like(blocks.depth), blocks.depth]))[0][:, : 2 if approach else 0]
    force = blocks.load - straight @ (straight.T @ blocks.load)
    beside = laws - straight @ (straight.T @ laws)
    power = np.maximum(np.sum(beside**2, axis=0), 1e-12)
    amplitude = force @ beside / power
    gained = np.where(amplitude > 0, amplitude**2 * power, -np.inf)
    best = int(np.argmax(gained))
    return float(contacts[best // len(LOG_PRIOR)]), float(force @ force - gained[best]) / len(force)


def begins_in_air(time: np.ndarray, load: np.ndarray, depth: np.ndarray) -> bool:
    """Return whether a loading (n,) needs a baseline.

    Without one the law begins some points later than the recording, or fits much worse. It needs none where what would
    be air bears much of the load, and obeys a law from its first point on: a crack or a pop-in is no contact.
    """
    contact, alone = coarse(time, load, depth, approach=False)
    later = contact - depth[0] > LATER * np.ptp(depth)
    if later and np.sum(depth[: len(depth) // 2] < contact) >= FEWEST_IN_AIR:
        begins = True
    else:
        contact, beside = coarse(time, load, depth, approach=True)
        begins = alone > max(MUCH_WORSE * beside, WELL**2)
    before = int(np.argmax(depth >= depth[0] + MOST_OF * (contact - depth[0])))
    if not begins or before < FEWEST_IN_AIR or np.ptp(load[:before]) < BORNE * np.ptp(load):
        return begins
    blocks = Blocks.even(200, time[:before], depth[:before], load[:before])
    first, of_law = coarse(time[:before], load[:before], depth[:before], approach=False)
    line = np.mean((blocks.load - np.polyval(np.polyfit(blocks.depth, blocks.load, 1), blocks.depth)) ** 2)
    return bool(np.sum(depth[:before] < first) >= FEWEST_IN_AIR or line < MUCH_WORSE * of_law)
