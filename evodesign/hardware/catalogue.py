"""The catalogue of actuators that can be ordered, and of gears by themselves: rows of `data/actuators.toml`.

    motor constant      K = k_t / sqrt(3 R)
    reflected inertia   J = N^2 J_rotor

with k_t the torque at the output per ampere (rms) of phase current, R the resistance of one of three phases
in star connection (half of what is measured between two terminals, however they are connected inside), N the
gear's ratio. What a source does not give is None; what a conversion would have to guess, too.

Source: `data/actuators.toml`, each row with its own and with the source's figures in its own units (`words`).
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.records import Record

ARC_MINUTE = math.pi / (180.0 * 60.0)

Figure = Annotated[float, Meta(gt=0.0)]


class Gear(StrEnum):
    """Kind of the gear between motor and output."""

    PLANETARY = "planetary"
    STRAIN_WAVE = "strain_wave"
    CYCLOIDAL = "cycloidal"


class CatalogueRow(Record, frozen=True, kw_only=True):
    """`[[actuator]]`: an actuator besides those of the catalogue, with the keys of the catalogue's rows.

    Torques are at the output and rise in the order rated, repeated peak, peak, momentary peak, ratcheting.
    Nothing is guessed where a source does not say. Mass and housing are without the drive where
    `separate_drive` is true.

    Attributes:
        model: name of the model.
        mass_kg: mass.
        peak_torque_n_m: peak torque for seconds.
        source: where the figures come from.
        maker: the maker. Since 0.3.
        gear: kind of its gear. Since 0.3.
        rated_torque_n_m: continuous torque.
        repeated_peak_torque_n_m: repeated peak torque of the gear at starts and stops. Since 0.3.
        momentary_peak_torque_n_m: momentary peak torque in collisions. Since 0.3.
        ratcheting_torque_n_m: torque at which a strain wave gear's teeth skip. Since 0.3.
        ratio: ratio of the gear.
        torque_constant_n_m_per_a: torque at the output per ampere (rms) of phase current.
        phase_resistance_ohm: resistance of one of three phases in star connection.
        rotor_inertia_kg_cm2: inertia of the rotor.
        output_inertia_kg_m2: inertia of the rotor as seen at the output. Since 0.3.
        no_load_speed_rpm: speed without load.
        max_speed_rpm: highest speed allowed, where none without load is given. Since 0.3.
        friction_torque_n_m: torque that turns the output without current. Since 0.3.
        load_friction: what friction grows by with the torque that the gear carries. Since 0.3.
        viscous_friction_n_m_s_per_rad: what friction grows by with the speed of the output. Since 0.3.
        no_load_loss_w: loss without load. Since 0.3.
        thermal_resistance_k_per_w: thermal resistance of the winding against the air. Since 0.3.
        thermal_time_constant_s: thermal time constant of the winding. Since 0.3.
        price_eur: price.
        diameter_m: diameter of the housing. Since 0.3.
        length_m: length of the housing. Since 0.3.
        separate_drive: whether the drive is a separate part. Since 0.3.
        in_default_law: whether the scaling laws are fitted to it. Since 0.3.
        words: the source's figures in its own units. Since 0.3.
    """

    model: str
    mass_kg: Figure
    peak_torque_n_m: Figure
    source: str
    maker: str = ""
    gear: Gear | None = None
    rated_torque_n_m: Figure | None = None
    repeated_peak_torque_n_m: Figure | None = None
    momentary_peak_torque_n_m: Figure | None = None
    ratcheting_torque_n_m: Figure | None = None
    ratio: Figure | None = None
    torque_constant_n_m_per_a: Figure | None = None
    phase_resistance_ohm: Figure | None = None
    rotor_inertia_kg_cm2: Figure | None = None
    output_inertia_kg_m2: Figure | None = None
    no_load_speed_rpm: Figure | None = None
    max_speed_rpm: Figure | None = None
    friction_torque_n_m: Figure | None = None
    load_friction: Annotated[float, Meta(ge=0.0, lt=1.0)] = 0.0
    viscous_friction_n_m_s_per_rad: Annotated[float, Meta(ge=0.0)] = 0.0
    no_load_loss_w: Figure | None = None
    thermal_resistance_k_per_w: Figure | None = None
    thermal_time_constant_s: Figure | None = None
    price_eur: Figure | None = None
    diameter_m: Figure | None = None
    length_m: Figure | None = None
    separate_drive: bool = False
    in_default_law: bool = False
    words: str = ""

    @property
    def housing(self) -> tuple[float, float] | None:
        """Diameter and length [m]."""
        given = self.diameter_m, self.length_m
        return None if given[0] is None or given[1] is None else (given[0], given[1])

    @property
    def motor_constant(self) -> float | None:
        """K = k_t / sqrt(3 R) [N m/W^0.5]."""
        if self.torque_constant_n_m_per_a is None or self.phase_resistance_ohm is None:
            return None
        return self.torque_constant_n_m_per_a / math.sqrt(3.0 * self.phase_resistance_ohm)

    @property
    def reflected_inertia(self) -> float | None:
        """Of the rotor at the output [kg m^2]: as given there, or N^2 J_rotor."""
        if self.output_inertia_kg_m2 is not None:
            return self.output_inertia_kg_m2
        if self.ratio is None or self.rotor_inertia_kg_cm2 is None:
            return None
        return self.ratio**2 * self.rotor_inertia_kg_cm2 * 1e-4

    @property
    def speed(self) -> float | None:
        """Without load, or the highest that the maker allows [rad/s]."""
        given = self.max_speed_rpm if self.no_load_speed_rpm is None else self.no_load_speed_rpm
        return None if given is None else given * math.tau / 60.0

    @property
    def torques(self) -> tuple[float, ...]:
        """Those that are given, in the order in which they rise [N m]."""
        given = (
            self.rated_torque_n_m,
            self.repeated_peak_torque_n_m,
            self.peak_torque_n_m,
            self.momentary_peak_torque_n_m,
            self.ratcheting_torque_n_m,
        )
        return tuple(torque for torque in given if torque is not None)


class Gearhead(Record, frozen=True, kw_only=True):
    """A gear by itself: the torque that it can carry for ever, and its stiffness."""

    model: str
    rated_torque_n_m: Figure
    stiffness_n_m_per_arcmin: Figure
    source: str
    gear: Gear = Gear.PLANETARY

    @property
    def relative_stiffness(self) -> float:
        """Stiffness per rated torque [1/rad]."""
        return self.stiffness_n_m_per_arcmin / ARC_MINUTE / self.rated_torque_n_m


class Catalogue(Record, frozen=True):
    """The whole data file."""

    sources: dict[str, str]
    actuators: tuple[CatalogueRow, ...]
    gearheads: tuple[Gearhead, ...]


@cache
def _file() -> Catalogue:
    text = resources.files("evodesign.hardware").joinpath("data", "actuators.toml").read_text("utf-8")
    return msgspec.convert(tomllib.loads(text), Catalogue)


def catalogue() -> Mapping[str, CatalogueRow]:
    """The actuators that every problem knows, by model."""
    return {row.model: row for row in _file().actuators}


def catalogue_sources() -> Mapping[str, str]:
    """What the rows' sources stand for."""
    return _file().sources


def gearheads(gear: Gear | str) -> tuple[Gearhead, ...]:
    """The gears by themselves of a kind."""
    return tuple(each for each in _file().gearheads if each.gear == gear)
