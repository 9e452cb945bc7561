#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The program and the baseline plugins on a processor without AVX (emulated):
# they must run, and give the bits that the baseline gives on this machine.
# usage: old_processor.sh SUTURE FOLDER
set -euo pipefail
suture=$1 folder=$2
emulator=$(command -v qemu-x86_64 || true)
if [ -z "$emulator" ] || [ "$(uname -m)" != x86_64 ]; then
  echo "needs qemu-x86_64 (Debian: qemu-user) on x86-64"
  exit 77
fi
rm -rf "$folder" && mkdir -p "$folder"

# scene MODEL: a beam of 4 elements, cut while it moves; no frames.
scene() {
  cat <<JSON
{"suture": 1, "title": "old processor",
 "mesh": {"box": {"size": [4, 1, 1], "cells": [4, 1, 1]}},
 "models": [{"model": "$1", "parameters": {"E": 1e5, "nu": 0.25, "rho": 1000}}],
 "gravity": {"value": [0, -9.8, 0]},
 "constraints": [{"fix": "xyz", "where": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}}],
 "events": [{"at": 0.005, "cut": {"plane": {"point": [3, 0, 0], "normal": [1, 0, 0]}}}],
 "solver": {"integrator": "velocity-verlet", "dt": 1e-3, "end": 0.02},
 "output": {"energies": {"every_steps": 1}}}
JSON
}

for model in mss-baudet tm-faure; do
  scene "$model" >"$folder/$model.json"
  "$emulator" -cpu Conroe "$suture" run -q "$folder/$model.json" -o "$folder/$model-old"
  SUTURE_ISA=base "$suture" run -q "$folder/$model.json" -o "$folder/$model-here"
  cmp "$folder/$model-old/energies.csv" "$folder/$model-here/energies.csv"
  [ "$(wc -l <"$folder/$model-old/energies.csv")" -ge 20 ] || { echo "$model: too few rows"; exit 1; }
done
"$emulator" -cpu Conroe "$suture" models
