"""The long fault campaign (`make faults`): python -m tests.faults.campaign [--kills N] [--folder DIR].

Kills searches, workers and commands until there were so many kills, and says what it found. Every finished
trial is a line of DIR/trials.jsonl; a campaign that was stopped or killed goes on from there when it is
called again, with what had findings first. A single trial is repeated with --trial N. Exit code 1 if
anything was lost, changed or left behind.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import msgspec

from tests.faults.damage import cut, flip, write_log
from tests.faults.trials import Outcome, tried
from tests.pool.cluster import Cluster

TRIALS = "trials.jsonl"


class Campaign:
    """Trials that are carried out, and those that were; shared by threads.

    Args:
        folder: of the campaign.
        seed: of all trials.
        kills: that are wanted.
    """

    def __init__(self, folder: Path, seed: int, kills: int) -> None:
        self.folder, self.seed, self.kills = folder, seed, kills
        folder.mkdir(parents=True, exist_ok=True)
        self.outcomes = _read(folder / TRIALS, seed)
        self._begun: set[int] = set()
        self._again = {number for number, outcome in self.outcomes.items() if outcome.finding}
        self._lock = threading.Lock()

    @property
    def counted(self) -> int:
        """Kills so far."""
        return sum(sum(outcome.kills.values()) for outcome in self.outcomes.values())

    def work(self) -> None:
        """Carry out trials, one after the other, until there were enough kills."""
        with Cluster() as cluster:
            cluster.start_scheduler()
            cluster.add_worker("--nthreads", "2", "--no-nanny")
            cluster.wait_for(workers=1)
            while (number := self._next()) is not None:
                self._add(tried(number, self.seed, self.folder / f"trial-{number}", cluster))

    def _next(self) -> int | None:
        with self._lock:
            if not self._again and self.counted >= self.kills:
                return None
            if self._again:
                return self._again.pop()
            number = next(n for n in range(len(self.outcomes) + len(self._begun) + 1) if self._free(n))
            self._begun.add(number)
            return number

    def _free(self, number: int) -> bool:
        return number not in self.outcomes and number not in self._begun

    def _add(self, outcome: Outcome) -> None:
        with self._lock:
            with (self.folder / TRIALS).open("ab") as file:
                file.write(msgspec.json.encode(outcome) + b"\n")
                file.flush()
                os.fsync(file.fileno())
            self._begun.discard(outcome.number)
            self.outcomes[outcome.number] = outcome
            told = outcome.finding or f"{sum(outcome.kills.values())} kills, nothing lost"
            say(f"{self.counted} of {self.kills}; trial {outcome.number} ({outcome.name}): {told}")


def _read(path: Path, seed: int) -> dict[int, Outcome]:
    """The outcomes of a seed by number; what a kill left of a line is removed from the file."""
    if not path.exists():
        return {}
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if whole != content:
        path.write_bytes(whole)
    found = [msgspec.json.decode(line, type=Outcome) for line in whole.splitlines()]
    return {outcome.number: outcome for outcome in found if outcome.seed == seed}


def summary(outcomes: Iterable[Outcome]) -> list[str]:
    """What a campaign did and found, as lines of text."""
    outcomes = list(outcomes)
    kinds, trials = Counter[str](), Counter[str]()
    for outcome in outcomes:
        kinds.update(outcome.kills)
        trials[outcome.name] += 1
    sessions, reported = (sum(getattr(each, key) for each in outcomes) for key in ("sessions", "reported"))
    findings = [each for each in outcomes if each.finding]
    return [
        *(f"  {count:5d} kills: {kind}" for kind, count in sorted(kinds.items())),
        *(f"  {count:5d} trials: {name}" for name, count in sorted(trials.items())),
        f"{kinds.total()} kills in {len(outcomes)} trials of {sessions} processes, {reported} evaluations "
        f"reported; {len(findings)} findings",
        *(f"trial {each.number} ({each.name}): {each.finding}" for each in findings),
    ]


def damage_logs(folder: Path, flips: int, cuts: int, seed: int) -> None:
    """Change bytes of a log and cut it off."""
    content = write_log(folder, 160)
    say(f"a log of {len(content)} bytes")
    began = time.monotonic()
    report = flip(folder, content, flips, seed)
    say(
        f"{report.logs} changed bytes: {report.unharmed} cost nothing, the others one evaluation, or all "
        f"behind a length ({time.monotonic() - began:.0f} s)"
    )
    began = time.monotonic()
    report = cut(folder, content, range(max(len(content) - cuts, 0), len(content)))
    say(f"{report.logs} cuts: always a prefix of what was written ({time.monotonic() - began:.0f} s)")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--kills", type=int, default=1000, help="of searches, workers and commands")
    parser.add_argument("--folder", type=Path, help="where the progress is kept (default: a new one)")
    parser.add_argument("--jobs", type=int, default=2, help="trials at the same time")
    parser.add_argument("--flips", type=int, default=500, help="bytes of a log changed, one at a time")
    parser.add_argument("--cuts", type=int, default=65536, help="last bytes of a log, each cut off there")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--trial", type=int, help="carry out this one alone")
    options = parser.parse_args()
    folder = options.folder or Path(tempfile.mkdtemp(prefix="faults-"))
    if options.trial is not None:
        return _alone(options.trial, options.seed, folder / "alone")
    campaign = Campaign(folder, options.seed, options.kills)
    say(f"the campaign lies in {folder}; {campaign.counted} kills so far")
    threads = [threading.Thread(target=campaign.work) for _ in range(options.jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    say("\n".join(summary(campaign.outcomes.values())))
    with tempfile.TemporaryDirectory() as name:
        damage_logs(Path(name), options.flips, options.cuts, options.seed)
    return int(any(outcome.finding for outcome in campaign.outcomes.values()))


def _alone(number: int, seed: int, folder: Path) -> int:
    with Cluster() as cluster:
        cluster.start_scheduler()
        cluster.add_worker("--nthreads", "2", "--no-nanny")
        cluster.wait_for(workers=1)
        outcome = tried(number, seed, folder, cluster)
    say("\n".join(summary([outcome])))
    return int(bool(outcome.finding))


def say(sentence: str) -> None:
    sys.stdout.write(sentence + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    raise SystemExit(main())
