"""Raw images of both sides, paired by stamp, and the reason where nothing pairs."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from sensor_msgs.msg import Image

from stereo_pick.core.arrays import Image as Pixels
from stereo_pick.core.errors import ImageError
from stereo_pick.core.hanging import STILL, HangWatch, all_alike, hangs
from stereo_pick.core.images import FULL_SCALE_16, pixels
from stereo_pick.core.pairing import MOST_OFFSET_S, Pair, PairingCounts, Side, StampOrder, StampPairer
from stereo_pick.core.params import Configurable, parameter
from stereo_pick.ros.messages.diagnostics import ERROR, WARN, Status
from stereo_pick.ros.messages.images import buffer_of
from stereo_pick.ros.messages.stamps import stamp_ns
from stereo_pick.ros.node import StepNode
from stereo_pick.ros.topics import IMAGE_RAW, SIDES

_SILENT_AFTER_S = 2.0
_PATIENCE = 3  # times as long as the longest of the last pauses between images: cameras may be triggered for each pick
_TICK_S = 0.1
_ON_ITS_WAY_S = 0.2  # what was taken no later than the last image has arrived by then
_RECENT = 40  # images over which those without partner are counted, and pauses
_TYPE = "sensor_msgs/msg/Image"
_LOST_ON_THE_WAY = "give its driver the Fast DDS profile, without which large images get lost (docs/nodes.md)"


@dataclass(frozen=True)
class RawImageOptions(Configurable):
    """How raw images are paired and read."""

    max_stamp_offset_s: float = parameter(
        0.01, "By how much the stamps of a left and a right image may differ.", low=0.0, high=MOST_OFFSET_S
    )
    full_scale_16: int = parameter(
        FULL_SCALE_16,
        "Value of a 16-bit image that becomes white; 4095 for a 12-bit camera.",
        low=1,
        high=FULL_SCALE_16,
    )

    def read(self, pair: Pair[Image]) -> tuple[Pixels, Pixels]:
        """Left and right decoded; raises ImageError, naming the side, on an image that is none."""
        left, right = (
            pixels(buffer_of(message), self.full_scale_16, f"{side} image")
            for side, message in (("left", pair.left), ("right", pair.right))
        )
        return left, right


class RawPairs:
    """Listens to `left|right/image_raw` for a node, once `listen` is called, and calls back with each pair."""

    def __init__(self, node: StepNode, paired: Callable[[Pair[Image]], None]) -> None:
        self._node = node
        self._paired = paired
        self._last_ns: dict[str, int] = {}
        self._since_ns: dict[Side, list[int]] = {side: [] for side in SIDES}  # of each: the other's next two images
        self._order = StampOrder()
        self._faults: dict[str, str] = {}
        self._watch = HangWatch()
        self.restart(0.0)

    def listen(self) -> None:
        """Subscribe to both images."""
        for side in SIDES:
            self._node.listen(IMAGE_RAW[side], partial(self._add, side))
        self._node.repeat(_TICK_S, self._on_tick)

    def restart(self, max_stamp_offset_s: float) -> None:
        """Pair by this offset of the stamps from now on."""
        self._patience_s = max_stamp_offset_s + _ON_ITS_WAY_S
        self._quiet_s = 0.0
        self._first_ns: int | None = None
        self._published_ns: int | None = None  # since when somebody publishes what does not arrive
        self._last_ns.clear()
        self._pauses_ns: deque[int] = deque(maxlen=_RECENT)
        for others in self._since_ns.values():
            others.clear()
        self._pairer: StampPairer[Image] = StampPairer(round(max_stamp_offset_s * 1e9))
        self._recent: deque[bool] = deque(maxlen=_RECENT)

    @property
    def counts(self) -> PairingCounts:
        """How many images came, and how many pairs."""
        return self._pairer.counts

    def flush(self) -> None:
        """Call back with what still waits for a better partner: nothing more comes."""
        for pair in self._pairer.flush():
            self._pass_on(pair)

    def trouble(self) -> Status | None:
        """What is missing or wrong with the last images, if anything is."""
        if self.counts.pairs == 0:
            return Status(self.missing_level(), self._why_no_pair())
        silent = [self._node.resolve_topic_name(IMAGE_RAW[side].name) for side in self._silent()]
        if not silent:
            self._published_ns = None
            if self._faults:
                return Status(ERROR, self._fault())
            return self._node.mixed() or self._many_unpaired() or self._all_alike()
        level = WARN if len(silent) == len(SIDES) else ERROR
        message = f"no image on {' and '.join(silent)} any more: is the camera running?"
        return Status(level, message + self._if_published(silent))

    def missing_level(self) -> bytes:
        """ERROR once images have been coming for so long that what belongs to them cannot just be on its way."""
        first_ns = self._first_ns
        waited = first_ns is not None and self._now_ns() - first_ns > _SILENT_AFTER_S * 1e9
        level: bytes = ERROR if waited else WARN
        return level

    def _why_no_pair(self) -> str:
        silent = [self._node.resolve_topic_name(IMAGE_RAW[side].name) for side in SIDES if side not in self._last_ns]
        if len(silent) == len(SIDES):
            return f"no image on {' and '.join(silent)}: are the cameras running?{self._if_published(silent)}"
        if silent:
            return f"no image on {silent[0]}: {self._pairer.explain()}{self._if_published(silent)}"
        return self._fault() if self._faults else self._pairer.explain()

    def _fault(self) -> str:
        """What is wrong with the stamps of the last images."""
        return " ".join(self._faults.values())

    def _if_published(self, topics: Sequence[str]) -> str:
        """What else may be wrong with topics on which nothing arrives although somebody publishes them."""
        types = [{each.topic_type for each in self._node.get_publishers_info_by_topic(topic)} for topic in topics]
        others = sorted(set().union(*types) - {_TYPE})
        if others:
            return (
                f" It is published as {' and '.join(others)}, not as {_TYPE}: remap to the raw images, or have "
                "image_transport's republish make them"
            )
        if not all(types):
            self._published_ns = None
            return ""
        if self._published_ns is None:
            self._published_ns = self._now_ns()
        if self._now_ns() - self._published_ns < _SILENT_AFTER_S * 1e9:  # as a driver that has just started
            return ""
        return f" It is published: if the camera does run, {_LOST_ON_THE_WAY}"

    def _many_unpaired(self) -> Status | None:
        """What to say where most of the last images found no partner."""
        unpaired = self._recent.count(False)
        if unpaired == _RECENT and self._pairer.is_apart:
            return Status(ERROR, self._pairer.explain_offset())
        if 2 * unpaired <= _RECENT:
            return None
        return Status(
            WARN,
            f"{unpaired} of the last {len(self._recent)} images found no partner: are the cameras synchronised, at one "
            f"rate? If they are, {_LOST_ON_THE_WAY}",
        )

    def _all_alike(self) -> Status | None:
        """The warning where both cameras send the same images again and again: nobody can tell from when they are."""
        return None if self._watch.still < STILL else Status(WARN, all_alike(f"the last {STILL} pairs"))

    def _silent(self) -> list[Side]:
        """Both sides where nothing comes any more, or the one that the other has left behind: by two images, since one
        is the partner of its last, and the second one's own may be on its way, however seldom they come."""
        now_ns, long_ns = self._now_ns(), _SILENT_AFTER_S * 1e9
        if now_ns - max(self._last_ns.values()) > max(long_ns, _PATIENCE * max(self._pauses_ns, default=0)):
            return list(SIDES)
        long_ago_ns = now_ns - long_ns
        return [side for side in SIDES if len(self._since_ns[side]) == 2 and self._since_ns[side][1] < long_ago_ns]

    def _on_tick(self) -> None:
        """Call back with the pair that waits for a nearer partner, once none can come any more: of cameras that are
        triggered for each part, it would wait for the next part."""
        self._quiet_s += _TICK_S  # not by the clock: after a node was held up, images may wait to be taken
        counts = self.counts
        waiting = (counts.left - counts.dropped_left, counts.right - counts.dropped_right)
        if self._quiet_s > self._patience_s and waiting == (counts.pairs + 1, counts.pairs + 1):
            self.flush()

    def _add(self, side: Side, message: Image) -> None:
        self._quiet_s = 0.0
        now_ns = self._now_ns()
        if side in self._last_ns:
            self._pauses_ns.append(now_ns - self._last_ns[side])
        self._last_ns[side] = now_ns
        self._first_ns = self._first_ns or now_ns
        self._since_ns[side].clear()
        for other in SIDES:
            if other != side and len(self._since_ns[other]) < 2:
                self._since_ns[other].append(now_ns)
        taken_ns = stamp_ns(message.header.stamp)
        fault = self._order.fault(side, taken_ns)
        if fault is not None:
            self._faults[side] = f"{self._node.resolve_topic_name(IMAGE_RAW[side].name)}: {fault}"
            raise ImageError(self._faults[side])
        self._faults.pop(side, None)
        if self._order.starts_over(side, taken_ns):
            self._pairer.flush()
        dropped = self._dropped()
        pairs = self._pairer.add(side, taken_ns, message)
        self._recent.extend([False] * (self._dropped() - dropped) + [True] * 2 * len(pairs))
        for pair in pairs:
            self._pass_on(pair)

    def _pass_on(self, pair: Pair[Image]) -> None:
        """Call back with the pair, unless one of its images was taken earlier than the other one."""
        side = self._watch.hanging(pair.left.data, pair.right.data)
        if side is not None:
            raise ImageError(hangs(self._node.resolve_topic_name(IMAGE_RAW[side].name)))
        self._paired(pair)
        self._node.went_well()

    def _dropped(self) -> int:
        return self.counts.dropped_left + self.counts.dropped_right

    def _now_ns(self) -> int:
        return self._node.steady_clock.now().nanoseconds
