"""The test that a diagnosis proposes, as a method that a laboratory can run and as the study that holds it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from indentation_files.recording import HEADER
from indentation_files.recording_file import recording_files
from indentation_files.whole_file import written_whole
from palpate.base.parameters import in_words
from palpate.base.rounding import percent
from palpate.configuration.study_file import Study
from palpate.data.study_recordings import written_by_workflow
from palpate.diagnosis.next_test import REPLICATES
from palpate.output.tip_words import tip_in_words
from palpate.study.indenter import Indenter

TRAPEZOID = ("max_load", "loading_time", "hold_time", "unloading_time")
APART = 20.0  # depths between sites; chosen, twice what P.S. Phani & W.C. Oliver, Mater. Des. 164 (2019) found enough


@dataclass(frozen=True, eq=False)
class Proposal:
    """The next test of one set of recordings.

    Parameters
    ----------
    study, values
        The study that was diagnosed, and its keys as its file holds them.
    recordings
        Name of the set.
    diagnosis
        Content of its ``diagnosis.json``, which proposes a test.
    folder
        Where method and study are written.
    """

    study: Study
    values: Mapping[str, Any]
    recordings: str
    diagnosis: Mapping[str, Any]
    folder: Path

    @property
    def test(self) -> Mapping[str, Any]:
        """What the diagnosis proposes, see `palpate.diagnosis.next_test.discriminating_test`."""
        found: Mapping[str, Any] = self.diagnosis["discriminating_test"]
        return found

    @property
    def name(self) -> str:
        """Name of its condition, which the study does not have yet."""
        names = [condition.name for condition in self.study.conditions]
        return next(name for k in range(len(names) + 1) if (name := f"next{k + 1}") not in names)

    @property
    def condition(self) -> dict[str, Any]:
        """Keys of its condition."""
        test = self.test
        tip = {"indenter": self.tip} if self.tip else {}
        if "low_load" not in test:
            return {"name": self.name} | {key: test[key] for key in TRAPEZOID} | tip | {"role": "calibrate"}
        rise, low, hold = test["loading_time"], test["low_load"], test["low_hold_time"]
        times = [rise, 1.9 * rise, 1.9 * rise + hold, 2.0 * rise + hold]
        return {"name": self.name, "times": times, "loads": [test["max_load"], low, low, 0.0], "role": "calibrate"}

    @property
    def tip(self) -> dict[str, Any] | str | None:
        """Keys of a tip that the study does not have, or the name of one that it has; None for its own."""
        size = {key: self.test[key] for key in ("radius", "half_angle") if key in self.test}
        if not size:
            return self.test.get("tip")
        kept = {
            key: self.values["indenter"][key]
            for key in ("friction", "modulus", "poisson_ratio")
            if key in self.values["indenter"]
        }
        shape = "sphere" if "radius" in size else "cone"
        name = f"sphere{1e-3 * size['radius']:g}" if "radius" in size else "berkovich"
        return {"name": name, "shape": shape} | size | kept

    @property
    def recordings_folder(self) -> str:
        """Where its recordings belong: beside the others, or with a copy of them where the workflow writes those."""
        if self.recordings in self.study.laboratory:
            return f"results/{self.study.name}_next/recordings/{self.recordings}"
        if written_by_workflow(self.study, self.recordings):
            return (self.folder / "recordings").as_posix()
        return self.study.recordings[self.recordings].as_posix()

    def next_study(self) -> dict[str, Any]:
        """Return the keys of the study with the test."""
        found = dict(self.values) | {"study": f"{self.study.name}_next"}
        found |= {"recordings": {self.recordings: self.recordings_folder}}
        if "laboratory" in found:
            found["laboratory"] = {key: each for key, each in found["laboratory"].items() if key == self.recordings}
        for key in ("source", "data", *(["laboratory"] if not found.get("laboratory") else [])):
            found.pop(key, None)
        found["conditions"] = [*found["conditions"], self.condition]
        if "all" in found.get("condition_sets", {}):
            found["condition_sets"] = {**found["condition_sets"], "all": [*found["condition_sets"]["all"], self.name]}
        return found

    def method(self) -> str:
        """Return the method as text."""
        return "\n".join([*self._purpose(), "", "Method", *(f"- {line}" for line in self._steps()), ""])

    def _purpose(self) -> Iterator[str]:
        test, verdict = self.test, self.diagnosis["verdict"]
        yield f"Next test for {self.study.name}, recordings {self.recordings} ({verdict}): {test['test']}"
        yield ""
        yield f"It separates: {' | '.join(in_words(name).replace('+', ' with ') for name in test['separates'])}."
        for name, value in test.get("hidden_effect", {}).items():
            yield f"The effect that could hide: {in_words(name).replace('.', ', ')} {value:.3g}."
        yield (
            f"Expected gain: {REPLICATES} such tests tell the two apart with a probability of "
            f"{percent(test['expected_power'])} (and with 1 % where there is no difference)."
        )

    def _steps(self) -> Iterator[str]:
        yield f"tip: {self._tip_in_words()}"
        yield f"load: {'; '.join(self._segments())}"
        yield f"number: {REPLICATES} tests, at sites {APART:g} times the depth or more from each other and from edges"
        yield "instrument, sample and settings as before; let the drift settle first as before"
        if self.recordings in self.study.laboratory:
            yield "recordings: the study's virtual laboratory writes them"
            return
        files = ", ".join(f"{self.name}_{k + 1}.csv" for k in range(REPLICATES))
        yield f"recordings: {files} with the header {HEADER}, in {self.recordings_folder}"

    def _tip_in_words(self) -> str:
        if isinstance(self.tip, Mapping):
            described = Indenter.from_mapping({key: value for key, value in self.tip.items() if key != "name"})
            return f"{tip_in_words(described)} - another one than before"
        if self.tip:
            return f"{self.tip}, {tip_in_words(self.study.tips[self.tip])}, as before"
        return f"{tip_in_words(self.study.indenter)}, the same as before"

    def _segments(self) -> Iterator[str]:
        """Yield each segment in words."""
        condition = self.condition
        if "times" not in condition:
            yield f"from 0 to {condition['max_load']:.4g} mN in {condition['loading_time']:.4g} s"
            if condition["hold_time"]:
                yield f"hold for {condition['hold_time']:.4g} s"
            yield f"to zero in {condition['unloading_time']:.4g} s"
            return
        before, start = 0.0, 0.0
        for time, load in zip(condition["times"], condition["loads"], strict=True):
            duration = time - start
            yield f"hold for {duration:.4g} s" if load == before else f"to {load:.4g} mN in {duration:.4g} s"
            before, start = load, time

    def write(self) -> list[Path]:
        """Write ``method.txt`` and ``study.yaml``; return these files.

        Recordings that were converted from a vendor's file are copied, so that the new ones can join them.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        if self.recordings == self.study.source.get("recordings"):
            Path(self.recordings_folder).mkdir(exist_ok=True)
            for file in recording_files(self.study.recordings[self.recordings]):
                shutil.copyfile(file, Path(self.recordings_folder) / file.name)
        head = f"# {self.study.name} with the test that method.txt describes.\n"
        dumped = yaml.safe_dump(
            self.next_study(), sort_keys=False, default_flow_style=None, width=110, allow_unicode=True
        )
        texts = {"method.txt": self.method(), "study.yaml": head + dumped}
        for name, text in texts.items():
            with written_whole(self.folder / name) as partial:
                partial.write_text(text, encoding="utf-8")
        return [self.folder / name for name in texts]
