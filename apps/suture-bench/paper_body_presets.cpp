// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/paper_body.hpp"

namespace suture::bench {
namespace {

const BodyPreset presets[] = {
    {.name = "frog",
     .parameters = {.torso = {0.5, 0.32, 0.24},
                    .leg_length = 0.34,
                    .leg_radius = 0.07,
                    .leg_x = 0.3,
                    .leg_y = 0.22,
                    .leg_splay = 0.16,
                    .head_length = 0.12,
                    .head_radius = 0.17,
                    .blend = 0.08},
     .cells = 2354,
     .faces_cut = 112,
     .cut_point = {-0.1, 0, 0},
     .cut_normal = {1, 0, 0}},
    {.name = "elephant",
     .parameters = {.torso = {0.6, 0.36, 0.4},
                    .leg_length = 0.75,
                    .leg_radius = 0.1,
                    .leg_x = 0.36,
                    .leg_y = 0.2,
                    .neck_length = 0.22,
                    .neck_radius = 0.2,
                    .neck_slope = 0.5,
                    .head_length = 0.16,
                    .head_radius = 0.22,
                    .nose_length = 0.7,
                    .nose_radius = 0.09,
                    .ear_radius = 0.22,
                    .ear_thickness = 0.05,
                    .tail_length = 0.35,
                    .tail_radius = 0.025,
                    .blend = 0.06},
     .cells = 125754,
     .faces_cut = 592,
     .cut_point = {0, 0, -0.5},
     .cut_normal = {0, 0, 1}},
    {.name = "mushroom",
     .parameters =
         {.torso = {0.18, 0.18, 0.5}, .cap_radius = 0.5, .cap_height = 0.3, .blend = 0.06},
     .cells = 27000,
     .faces_cut = 987,
     .cut_point = {0.095, 0, 0},
     .cut_normal = {1, 0, 0}},
    {.name = "giraffe",
     .parameters = {.torso = {0.5, 0.108, 0.27},
                    .leg_length = 1.0,
                    .leg_radius = 0.045,
                    .leg_x = 0.3,
                    .leg_y = 0.07,
                    .leg_splay = 0.02,
                    .neck_length = 1.1,
                    .neck_radius = 0.08,
                    .neck_slope = 1.1,
                    .head_length = 0.28,
                    .head_radius = 0.075,
                    .ear_radius = 0.06,
                    .ear_thickness = 0.03,
                    .tail_length = 0.4,
                    .tail_radius = 0.025,
                    .blend = 0.05},
     .cells = 85405,
     .faces_cut = 5210,
     .cut_point = {0, 0, 0},
     .cut_normal = {0, 1, 0}},
};

}  // namespace

std::span<const BodyPreset> body_presets() { return presets; }

}  // namespace suture::bench
