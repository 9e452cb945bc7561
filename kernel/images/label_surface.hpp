// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/surface.hpp"
#include "kernel/images/label_image.hpp"

namespace suture {

/// The closed surface around the voxels that belong to regions, smoothed within half a voxel.
///
/// Two triangles for each side that a voxel shares with the outside, with the corners of the voxels
/// as points. Where a surface is not parallel to the axes of the image, these are stairs. As in
/// constrained elastic surface nets (Gibson, MICCAI 1998), the points are moved towards the means
/// of their neighbours, by at most half a voxel along each axis; here with the steps of Taubin
/// (SIGGRAPH 1995), which keep volumes: those of balls of 5 voxels in radius to 0.5 %.
///
/// Throws InputError if the surface needs more than `memory` bytes, about 150 per side. Costs 2 ns
/// per voxel and 3 us per side.
TriangleSurface surface_of(const LabelImage& image, double memory = available_memory());

}  // namespace suture
