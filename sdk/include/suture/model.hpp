// SPDX-License-Identifier: MIT
//
// suture/model.hpp - from one C++ struct to the tables of plugin.h.
//
// A model is a struct of constants and static function templates:
//
//   #include "suture/model.hpp"
//
//   struct Drag : suture::model, suture::on_edges {       // model and functor in one
//     static constexpr const char* id = "drag";
//     static constexpr const char* doc = "Edges that resist their own motion";
//     static constexpr const char* formula = "f_n = -c v_n / 2";
//     static constexpr const char* citation = "textbook";
//     enum { c };
//     static constexpr suture::parameter parameters[] = {
//         suture::number("c", "N s/m", "drag of one edge").at_least(0)};
//     static constexpr auto reads = SUTURE_READ_VELOCITY;
//     template <class Cell> static void force(Cell& e) {
//       for (int n = 0; n < 2; ++n) e.force(n, -0.5 * e.parameter(c) * e.velocity(n));
//     }
//   };
//   SUTURE_PLUGIN("drag", "1.0", "MIT", "Drag on edges", Drag)
//
// A model with several functors lists them instead of being one itself:
//   using functors = suture::list<EdgeSprings, InnerSprings>;
//
// Members of a model (M: mandatory, others optional):
//   M id, doc, formula, citation            const char*
//     flags                                 suture_model_flag bits
//     parameters[]                          suture::parameter
//     attributes[]                          suture::attribute
//     functors                              suture::list<...>
//     Constants, prepare(setup, Constants&) what functors derive from parameters; if these may
//                                           differ from element to element, Constants<R>
// Members of a functor, besides those of its base (on_vertices, on_edges, on_faces,
// on_volumes):
//   M force(Cell&)                          sets the force on every node, or
//     rate_of, rate(Cell&)                  the field that it changes, and the rate of every node
//     reads                                 suture_read bits; positions alone otherwise
//     cell_columns, vertex_columns          columns(...), see columns.hpp
//     energy(const Cell&)                -> T, J
//     bounds(const Cell&, bound_matrices&)  for the stable step
//     fields[], output(const Cell&, results&)
//     inspect(const Cell&)                  reports on rest shapes
//     enabled(values, uint32_t& reads)   -> bool
//     element_parameters                    bool: on volumes, parameters that may differ from
//                                           element to element are read
//     alternative                           number of a group of which only one runs
//     allows_parts                          bool: may run on bodies with elements of which only a
//                                           part is material
// Members that are present are offered to the host; a function with one of these names
// that cannot be called as shown is a compile-time error. The tangent is always offered,
// from force() on dual numbers; without bounds(), the stable step is computed from it by
// power iteration.
// Functions may throw suture::failure; any other exception is a fault of the plugin.
#ifndef SUTURE_MODEL_HPP
#define SUTURE_MODEL_HPP

#include "suture/declarations.hpp"
#include "suture/detail/tables.hpp"
#include "suture/note.h"

/// Exports the plugin. Use it once, in one source file, after the models.
#define SUTURE_PLUGIN(plugin_id, plugin_version, plugin_license, plugin_doc, ...)             \
  SUTURE_NOTE_STORAGE constexpr suture_note suture_note_of_this_plugin =                      \
      suture::detail::note_of<__VA_ARGS__>(plugin_id);                                        \
  extern "C" __attribute__((visibility("default"))) const suture_plugin* suture_plugin_v1() { \
    static constexpr auto plugin = suture::detail::plugin_of<__VA_ARGS__>(                    \
        plugin_id, plugin_version, plugin_license, plugin_doc);                               \
    return &plugin;                                                                           \
  }

#endif
