// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/nearest.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::testing {

/// A model that consists of its table only, as the scene reader sees it.
inline const suture_model& jelly() {
  static const char* const quadratures[] = {"exact", "gauss2"};
  static const auto parameter = [](const char* name, const char* unit, std::uint32_t type,
                                   std::uint32_t flags, double value, double minimum,
                                   double maximum) {
    suture_parameter p{};
    p.size = sizeof p;
    p.type = type;
    p.flags = flags;
    p.name = name;
    p.unit = unit;
    p.doc = name;
    p.default_value = value;
    p.minimum = minimum;
    p.maximum = maximum;
    return p;
  };
  static const suture_parameter parameters[] = {
      parameter("E", "Pa", SUTURE_NUMBER, SUTURE_REQUIRED | SUTURE_MINIMUM_EXCLUDED, 0, 0,
                INFINITY),
      parameter("nu", "1", SUTURE_NUMBER, SUTURE_MINIMUM_EXCLUDED | SUTURE_MAXIMUM_EXCLUDED, 0.3,
                -1, 0.5),
      parameter("order", "1", SUTURE_INTEGER, 0, 2, 1, 9),
      parameter("correction", "1", SUTURE_BOOLEAN, 0, 1, 0, 1), [] {
        suture_parameter p = parameter("quadrature", "1", SUTURE_CHOICE, 0, 1, 0, 1);
        p.choices = quadratures;
        p.choice_count = 2;
        return p;
      }()};
  static const suture_attribute attributes[] = {[] {
    suture_attribute a{};
    a.size = sizeof a;
    a.dimension = 3;
    a.components = 1;
    a.flags = SUTURE_OUTPUT;
    a.name = "wobble";
    return a;
  }()};
  static const suture_model model = [] {
    suture_model m{};
    m.size = sizeof m;
    m.id = "jelly";
    m.parameter_count = 5;
    m.parameters = parameters;
    m.attribute_count = 1;
    m.attributes = attributes;
    return m;
  }();
  return model;
}

inline ModelLookup jelly_only() {
  return {[](std::string_view id) -> const suture_model& {
            if (id == "jelly") return jelly();
            const std::vector<std::string> known{"jelly"};
            throw PluginError("no model '" + std::string(id) + "'" + did_you_mean(id, known));
          },
          [](const std::filesystem::path& file) {
            throw PluginError("no plugin file '" + file.string() + "'");
          }};
}

inline Scene read(const std::string& text, const std::vector<std::string>& sets = {}) {
  Diagnostics diagnostics;
  return read_scene_text(text, "folder/s.json", sets, jelly_only(), diagnostics);
}

/// The text of the error of reading, or "" if there is none.
inline std::string error_of(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    read(text, sets);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// A scene with a full stop after it: `more` are further members, ", \"events\": ...".
inline std::string scene_with(const std::string& more) {
  return R"({"suture": 1, "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
"models": [{"model": "jelly", "parameters": {"E": 1000}}],
"solver": {"end": 1})" +
         more + "}";
}

}  // namespace suture::testing
