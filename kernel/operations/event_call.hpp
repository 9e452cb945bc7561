// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/operations/cut_along.hpp"
#include "kernel/operations/cut_faces.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/operations/match_faces.hpp"

namespace suture {

/// One operation on its way: everything it needs, and an overload per kind, which finds the cells
/// and passes them to the body.
struct EventRunner::Call {
  EventRunner& runner;
  const Event& event;
  std::uint32_t number;  ///< of the event in the scene, or none
  double time;
  State& state;
  BuiltScene& built = runner.built_;

  EventOutcome operator()(const CutPlane& plane) const;
  EventOutcome operator()(const CutSurface&) const;
  EventOutcome operator()(const CutBlade& cut) const;
  EventOutcome operator()(const CutFaces& listed) const;
  EventOutcome operator()(const Pierce& pierce) const;
  EventOutcome operator()(const RemoveIslands& islands) const;
  EventOutcome operator()(const Grasp& grasp) const;
  EventOutcome operator()(const Release& release) const;
  EventOutcome operator()(const SewFaces& sew) const;
  EventOutcome operator()(const Tear&) const;

  // ---- places

  const double* rows(bool at_rest) const;
  const double* shape() const;
  const ElementBlocks& blocks(bool at_rest) const;
  const ElementBlocks* blocks() const;
  std::vector<Index> elements_now(const Selection& selection, bool at_rest) const;
  const Workers* workers() const;

  // ---- messages

  void warn(const std::string& text) const;
  /// Warns about an event that happens once; finish() reports repeated events after the run.
  void warn_once(const std::string& text) const;
  void report_pairs(const char* one, const char* many, const std::vector<ElementPair>& pairs) const;
  /// What else it can be that nothing is cut, once anything has been done to the map.
  std::string or_is_cut() const;
  void warn_of_area(const EventOutcome& outcome) const;
  static std::string why_none(const SewFaces& sew);
  /// Cells by the numbers of the user's mesh.
  Naming naming() const;

  // ---- cuts along faces

  EventOutcome cut(const std::vector<Dart>& faces) const;
  EventOutcome opened(const std::vector<Dart>& faces) const;
  Index cut_now(const std::vector<Dart>& faces, EventOutcome& outcome) const;
  /// Both sides of each belong to the cut.
  void open_sides(const std::vector<Dart>& faces) const;
  /// Those of events that are not part of the scene follow.
  Index cut_number() const;
  ListedFaces faces_of(const CutFaces& listed) const;

  // ---- cuts along blades

  EventOutcome cut_along_blade(const Blade& blade) const;
  EventOutcome cut_along_sheet() const;
  EventOutcome cut_to(const std::vector<Vec3>& edge, double at, bool is_last) const;
  EventOutcome divide(const BladeCut& cut) const;
  void sew_ties(const std::vector<Seam>& seams) const;

  // ---- removals and seams

  EventOutcome remove(const std::vector<Index>& elements, const char* nothing) const;
  TopologyChange sew_now(const std::vector<Seam>& seams) const;
  Index sew_divided(const SewFaces& sew) const;
  std::vector<Seam> seams_of(const SewFaces& sew) const;
  std::vector<Seam> listed_seams(const SewFaces& sew) const;
  std::vector<Seam> without_misfits(MatchedSeams matched) const;
};

}  // namespace suture
