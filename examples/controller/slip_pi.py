"""A slip control of one's own: one torque for each bogie, by a PI law on the slip of its fastest axle.

It is the law of the vehicle's own controller, so that both give the same run: a start for another one.
"""

from collections.abc import Mapping

BOGIES = {"bogie1": ("ws1", "ws2", "ws3"), "bogie2": ("ws4", "ws5", "ws6")}


class SlipPI:
    """Made anew for every run, with the numbers of the spec's `parameters`."""

    def __init__(self, kp: float, ki: float, slip_reference: float, torque_limit: float) -> None:
        self.kp, self.ki = kp, ki
        self.slip_reference, self.torque_limit = slip_reference, torque_limit
        self.integral = dict.fromkeys(BOGIES, 0.0)

    def __call__(self, t: float, seen: Mapping[str, float]) -> dict[str, float]:
        """Called every period with the time (s) and the declared inputs; gives the declared outputs, N m."""
        return {f"{bogie}.torque": self.torque(bogie, axles, seen) for bogie, axles in BOGIES.items()}

    def torque(self, bogie: str, axles: tuple[str, ...], seen: Mapping[str, float]) -> float:
        """Torque on each axle of a bogie, between nothing and the limit; the integral does not wind up there."""
        error = self.slip_reference - max(seen[f"{axle}.slip"] for axle in axles)
        proportional = self.kp * error
        integral = self.integral[bogie] + self.ki * error * seen["period"]
        most = max(self.torque_limit - proportional, 0.0)
        self.integral[bogie] = min(max(integral, min(-proportional, 0.0)), most)
        return min(max(proportional + self.integral[bogie], 0.0), self.torque_limit)
