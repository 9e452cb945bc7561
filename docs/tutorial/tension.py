"""Draws the force of tension.json against the stroke, beside the points of the test."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

data = np.genfromtxt("tension.csv", delimiter=",", comments="#", skip_header=2)
run = np.genfromtxt("out/tension/tools.csv", delimiter=",", names=True, deletechars="")
stroke = np.interp(run["time_[s]"], data[:, 0], data[:, 1])
force = -run["clamp_force_x_[N]"]
measured = np.interp(run["time_[s]"], data[:, 0], data[:, 2])
print(f"largest force: {force.max():.3f} N, measured {data[:, 2].max():.3f} N")
print(f"root mean square of the difference: {np.sqrt(np.mean((force - measured) ** 2)):.4f} N")

plt.plot(data[:, 1], data[:, 2], "o", label="measured")
plt.plot(stroke, force, label="computed")
plt.xlabel("stroke [mm]")
plt.ylabel("force [N]")
plt.legend()
plt.savefig("tension.png")
