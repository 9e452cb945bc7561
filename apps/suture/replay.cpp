// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdlib>

#include "apps/suture/commands.hpp"
#include "apps/suture/failed_check.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/islands.hpp"
#include "kernel/topology/journal.hpp"

namespace suture {
namespace {

std::string text_of(const Request& request) {
  std::string text = std::string(name_of(request.kind)) + " of ";
  switch (request.kind) {
    case Operation::Kind::pierce:
      text += count(request.elements.size(), "element");
      break;
    case Operation::Kind::sew:
      text += count(request.seams.size(), "face");
      break;
    case Operation::Kind::clone: {
      std::vector<Index> elements = request.cloning.origins;
      sort_unique(elements);
      text += count(elements.size(), "element") +
              ", copies: " + std::to_string(request.cloning.origins.size());
      break;
    }
    default:
      text += count(request.faces.size(), "face");
  }
  if (request.left_out > 0) text += " (" + std::to_string(request.left_out) + " impossible)";
  return text;
}

/// "; splits 4 vertices, 4 edges, 1 face" for what was not nothing.
template <class Cells>
std::string counts(const char* what, const Cells& cells) {
  constexpr const char* one[] = {"vertex", "edge", "face", "element"};
  constexpr const char* many[] = {"vertices", "edges", "faces", "elements"};
  std::string text;
  for (std::size_t d = 0; d < cells.size(); ++d)
    if (const std::size_t n = cells[d].size(); n > 0)
      text += (text.empty() ? std::string("; ") + what + " " : std::string(", ")) +
              std::to_string(n) + " " + (n == 1 ? one[d] : many[d]);
  return text;
}

/// Returns what happened; a law that does not hold afterwards is a TopologyError.
std::string perform(const Request& request, CellComplex& complex, Islands& islands) {
  TopologyChange change;
  try {
    change = apply(complex, request);
  } catch (const TopologyError& error) {
    complex.validate();  // refused: then nothing has happened
    islands.validate(complex);
    return std::string(": refused: ") + error.what();
  }
  islands.update(complex, change);
  complex.validate();
  islands.validate(complex);
  return counts("splits", change.splits) + counts("merges", change.merges) +
         counts("removes", change.removed) + "; " + count(islands.existing(), "island");
}

// In this process: a debugger can follow.
int replay_check(const ReplayCommand& command, Console& console) {
  FailedCheck failed = read_failed_check(command.journal);
  setenv("SUTURE_ISA", failed.isa.c_str(), 1);
  PluginHost host(&console.diagnostics(), trust_of(command));
  if (std::filesystem::exists(failed.plugin)) host.add_file(failed.plugin);
  const suture_model& model = host.model(failed.model);
  const ModelCheck& check = find_check(failed.check);
  resolve(failed, model);
  const suture_model* const builds[] = {&model};
  const CheckOutcome outcome = repeat_check(check, builds, failed.sample, failed.batch);
  const std::string what =
      command.journal.string() + ", check " + failed.check + " of model '" + failed.model + "': ";
  if (outcome.status == CheckOutcome::Status::failed) throw PluginError(what + outcome.text);
  console.print(what + "passed");
  return 0;
}

}  // namespace

int replay(const ReplayCommand& command, Console& console) {
  if (is_failed_check(command.journal)) return replay_check(command, console);
  const Journal journal = read_journal(command.journal);
  CellComplex complex(journal.mesh.hexahedra, static_cast<Index>(journal.mesh.points.size()));
  complex.require_edges();
  complex.require_faces();
  Islands islands(complex);
  for (std::size_t i = 0; i < journal.operations.size(); ++i) {
    const Request wanted = request(complex, journal.operations[i]);
    const std::string what = "operation " + std::to_string(i + 1) + ": " + text_of(wanted);
    try {
      const std::string happened = perform(wanted, complex, islands);
      console.note(what + happened);
    } catch (const TopologyError& error) {
      throw TopologyError(command.journal.string() + ", " + what +
                          " broke the map: " + error.what());
    }
  }
  console.print(command.journal.string() + ": valid (" +
                count(journal.operations.size(), "operation") + " on " +
                count(complex.element_count(), "element") + ", map valid after each)");
  return 0;
}

}  // namespace suture
