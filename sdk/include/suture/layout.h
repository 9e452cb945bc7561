/* SPDX-License-Identifier: MIT
 *
 * suture/layout.h - the layout of every struct of plugin.h, asserted.
 *
 * Host and plugin may come from different compilers, languages and flags; these
 * numbers are what they share. A compiler that lays out a struct differently
 * (packing pragmas, another ABI) stops here instead of reading wrong values. The
 * numbers hold for 64-bit pointers. New members go at the end of a struct and get
 * a new line; published lines never change. plugin.h includes this file.
 */
#ifndef SUTURE_LAYOUT_H
#define SUTURE_LAYOUT_H

#include "suture/plugin.h"

#if UINTPTR_MAX == UINT64_MAX

#ifdef __cplusplus
#define SUTURE_LAYOUT(condition, text) static_assert(condition, text)
#else
#define SUTURE_LAYOUT(condition, text) _Static_assert(condition, text)
#endif
#define SUTURE_SIZE(type, bytes) SUTURE_LAYOUT(sizeof(type) == bytes, "size of " #type);
#define SUTURE_AT(type, member, offset) \
  SUTURE_LAYOUT(offsetof(type, member) == offset, "offset of " #type "." #member);

SUTURE_SIZE(suture_error, 536)
SUTURE_AT(suture_error, size, 0)
SUTURE_AT(suture_error, code, 4)
SUTURE_AT(suture_error, cell, 8)
SUTURE_AT(suture_error, reserved, 12)
SUTURE_AT(suture_error, step_factor, 16)
SUTURE_AT(suture_error, text, 24)

SUTURE_SIZE(suture_parameter, 72)
SUTURE_AT(suture_parameter, size, 0)
SUTURE_AT(suture_parameter, type, 4)
SUTURE_AT(suture_parameter, flags, 8)
SUTURE_AT(suture_parameter, choice_count, 12)
SUTURE_AT(suture_parameter, name, 16)
SUTURE_AT(suture_parameter, unit, 24)
SUTURE_AT(suture_parameter, doc, 32)
SUTURE_AT(suture_parameter, default_value, 40)
SUTURE_AT(suture_parameter, minimum, 48)
SUTURE_AT(suture_parameter, maximum, 56)
SUTURE_AT(suture_parameter, choices, 64)

SUTURE_SIZE(suture_contribution, 16)
SUTURE_AT(suture_contribution, size, 0)
SUTURE_AT(suture_contribution, cell_type, 4)
SUTURE_AT(suture_contribution, function, 8)

SUTURE_SIZE(suture_attribute, 80)
SUTURE_AT(suture_attribute, size, 0)
SUTURE_AT(suture_attribute, dimension, 4)
SUTURE_AT(suture_attribute, components, 8)
SUTURE_AT(suture_attribute, policy, 12)
SUTURE_AT(suture_attribute, flags, 16)
SUTURE_AT(suture_attribute, contribution_count, 20)
SUTURE_AT(suture_attribute, name, 24)
SUTURE_AT(suture_attribute, unit, 32)
SUTURE_AT(suture_attribute, doc, 40)
SUTURE_AT(suture_attribute, initial, 48)
SUTURE_AT(suture_attribute, contributions, 56)
SUTURE_AT(suture_attribute, minimum, 64)
SUTURE_AT(suture_attribute, maximum, 72)

SUTURE_SIZE(suture_batch, 96)
SUTURE_AT(suture_batch, size, 0)
SUTURE_AT(suture_batch, lanes, 4)
SUTURE_AT(suture_batch, valid, 8)
SUTURE_AT(suture_batch, nodes, 12)
SUTURE_AT(suture_batch, time, 16)
SUTURE_AT(suture_batch, dt, 24)
SUTURE_AT(suture_batch, rest, 32)
SUTURE_AT(suture_batch, position, 40)
SUTURE_AT(suture_batch, velocity, 48)
SUTURE_AT(suture_batch, cell_columns, 56)
SUTURE_AT(suture_batch, vertex_columns, 64)
SUTURE_AT(suture_batch, cell_ids, 72)
SUTURE_AT(suture_batch, force, 80)
SUTURE_AT(suture_batch, trial_columns, 88)

SUTURE_SIZE(suture_host, 24)
SUTURE_AT(suture_host, size, 0)
SUTURE_AT(suture_host, abi_minor, 4)
SUTURE_AT(suture_host, report, 8)
SUTURE_AT(suture_host, has_extension, 16)

SUTURE_SIZE(suture_context, 48)
SUTURE_AT(suture_context, size, 0)
SUTURE_AT(suture_context, parameter_count, 4)
SUTURE_AT(suture_context, parameters, 8)
SUTURE_AT(suture_context, instance, 16)
SUTURE_AT(suture_context, host, 24)
SUTURE_AT(suture_context, error, 32)
SUTURE_AT(suture_context, host_data, 40)

SUTURE_SIZE(suture_functor, 112)
SUTURE_AT(suture_functor, size, 0)
SUTURE_AT(suture_functor, dimension, 4)
SUTURE_AT(suture_functor, cell_type, 8)
SUTURE_AT(suture_functor, shape, 12)
SUTURE_AT(suture_functor, faces, 16)
SUTURE_AT(suture_functor, lanes, 20)
SUTURE_AT(suture_functor, scalar, 24)
SUTURE_AT(suture_functor, reads, 28)
SUTURE_AT(suture_functor, cell_column_count, 32)
SUTURE_AT(suture_functor, vertex_column_count, 36)
SUTURE_AT(suture_functor, alternative, 40)
SUTURE_AT(suture_functor, reserved, 44)
SUTURE_AT(suture_functor, cell_columns, 48)
SUTURE_AT(suture_functor, vertex_columns, 56)
SUTURE_AT(suture_functor, name, 64)
SUTURE_AT(suture_functor, doc, 72)
SUTURE_AT(suture_functor, force, 80)
SUTURE_AT(suture_functor, extension, 88)
SUTURE_AT(suture_functor, enabled, 96)
SUTURE_AT(suture_functor, field, 104)
SUTURE_AT(suture_functor, reserved_2, 108)

SUTURE_SIZE(suture_model, 104)
SUTURE_AT(suture_model, size, 0)
SUTURE_AT(suture_model, flags, 4)
SUTURE_AT(suture_model, id, 8)
SUTURE_AT(suture_model, doc, 16)
SUTURE_AT(suture_model, formula, 24)
SUTURE_AT(suture_model, citation, 32)
SUTURE_AT(suture_model, parameter_count, 40)
SUTURE_AT(suture_model, attribute_count, 44)
SUTURE_AT(suture_model, functor_count, 48)
SUTURE_AT(suture_model, reserved, 52)
SUTURE_AT(suture_model, parameters, 56)
SUTURE_AT(suture_model, attributes, 64)
SUTURE_AT(suture_model, functors, 72)
SUTURE_AT(suture_model, prepare, 80)
SUTURE_AT(suture_model, instance_bytes, 88)
SUTURE_AT(suture_model, extension, 96)

SUTURE_SIZE(suture_plugin, 80)
SUTURE_AT(suture_plugin, size, 0)
SUTURE_AT(suture_plugin, magic, 4)
SUTURE_AT(suture_plugin, abi_major, 8)
SUTURE_AT(suture_plugin, abi_minor, 12)
SUTURE_AT(suture_plugin, lanes, 16)
SUTURE_AT(suture_plugin, model_count, 20)
SUTURE_AT(suture_plugin, id, 24)
SUTURE_AT(suture_plugin, version, 32)
SUTURE_AT(suture_plugin, license, 40)
SUTURE_AT(suture_plugin, description, 48)
SUTURE_AT(suture_plugin, models, 56)
SUTURE_AT(suture_plugin, required_extension_count, 64)
SUTURE_AT(suture_plugin, reserved, 68)
SUTURE_AT(suture_plugin, required_extensions, 72)

SUTURE_SIZE(suture_energy_1, 16)
SUTURE_AT(suture_energy_1, size, 0)
SUTURE_AT(suture_energy_1, reserved, 4)
SUTURE_AT(suture_energy_1, energy, 8)

SUTURE_SIZE(suture_stable_dt_1, 16)
SUTURE_AT(suture_stable_dt_1, size, 0)
SUTURE_AT(suture_stable_dt_1, reserved, 4)
SUTURE_AT(suture_stable_dt_1, bounds, 8)

SUTURE_SIZE(suture_field, 32)
SUTURE_AT(suture_field, size, 0)
SUTURE_AT(suture_field, components, 4)
SUTURE_AT(suture_field, name, 8)
SUTURE_AT(suture_field, unit, 16)
SUTURE_AT(suture_field, doc, 24)

SUTURE_SIZE(suture_output_1, 24)
SUTURE_AT(suture_output_1, size, 0)
SUTURE_AT(suture_output_1, field_count, 4)
SUTURE_AT(suture_output_1, fields, 8)
SUTURE_AT(suture_output_1, compute, 16)

SUTURE_SIZE(suture_tangent_1, 16)
SUTURE_AT(suture_tangent_1, size, 0)
SUTURE_AT(suture_tangent_1, reserved, 4)
SUTURE_AT(suture_tangent_1, apply, 8)

SUTURE_SIZE(suture_inspect_1, 16)
SUTURE_AT(suture_inspect_1, size, 0)
SUTURE_AT(suture_inspect_1, reserved, 4)
SUTURE_AT(suture_inspect_1, inspect, 8)

#undef SUTURE_AT
#undef SUTURE_SIZE
#undef SUTURE_LAYOUT

#endif
#endif
