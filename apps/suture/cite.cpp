// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <vector>

#include "apps/suture/commands.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

struct Reference {
  std::string for_what, source;
};

bool has_implicit_steps(const SolverOptions& solver) {
  return solver.integrator != "symplectic-euler" && solver.integrator != "velocity-verlet";
}

std::vector<Reference> references_of_solver(const Scene& scene) {
  const SolverOptions& solver = scene.solver;
  std::vector<Reference> list;
  if (!has_implicit_steps(solver))
    list.push_back(
        {"explicit steps (" + solver.integrator + ")",
         "E. Hairer, C. Lubich, G. Wanner: Geometric numerical integration illustrated by "
         "the Stormer-Verlet method. Acta Numerica 12, 2003, 399-450"});
  if (solver.integrator == "newmark")
    list.push_back({"implicit steps (newmark)",
                    "N. M. Newmark: A method of computation for structural dynamics. J. Eng. Mech. "
                    "Div. ASCE 85, 1959, 67-94"});
  if (has_implicit_steps(solver)) {
    list.push_back(
        {"Newton's method, forcing terms",
         "S. C. Eisenstat, H. F. Walker: Choosing the forcing terms in an inexact Newton "
         "method. SIAM J. Sci. Comput. 17, 1996, 16-32"});
    list.push_back(
        {"Newton's method, line search",
         "H. Matthies, G. Strang: The solution of nonlinear finite element equations. Int. "
         "J. Numer. Methods Eng. 14, 1979, 1613-1626"});
  }
  if (solver.follow_path)
    list.push_back({"paths through limit points",
                    "E. Riks: An incremental approach to the solution of snapping and buckling "
                    "problems. Int. J. Solids Struct. 15, 1979, 529-551"});
  if (solver.step_error)
    list.push_back(
        {"steps by their error",
         "O. C. Zienkiewicz, Y. M. Xie: A simple error estimator and adaptive time "
         "stepping procedure for dynamic analysis. Earthquake Eng. Struct. Dyn. 20, 1991, "
         "871-887"});
  if (solver.until_rest)
    list.push_back({"stability at rest",
                    "A. V. Knyazev: Toward the optimal preconditioned eigensolver. SIAM J. Sci. "
                    "Comput. 23, 2001, 517-541"});
  return list;
}

std::vector<Reference> references_of_contact(const Scene& scene) {
  std::vector<Reference> list;
  if (!scene.contact.is_wanted()) return list;
  if (has_implicit_steps(scene.solver) && !scene.contact.penalty)
    list.push_back(
        {"contact by multipliers",
         "J. C. Simo, T. A. Laursen: An augmented Lagrangian treatment of contact problems "
         "involving friction. Comput. Struct. 42, 1992, 97-116"});
  list.push_back(
      {"sides of a surface",
       "J. A. Baerentzen, H. Aanaes: Signed distance computation using the angle weighted "
       "pseudonormal. IEEE Trans. Vis. Comput. Graph. 11, 2005, 243-253"});
  return list;
}

void print(const Reference& reference, Console& console) {
  console.print(reference.for_what + "\n    " + reference.source);
}

}  // namespace

// The sources of the program, the models and the methods that a scene uses.
int cite(const CiteCommand& command, Console& console) {
  PluginHost host(&console.diagnostics(), trust_of(command));
  const Scene scene = read_scene(command.scene, command.sets, host, console.diagnostics());
  print({"Suture: cuts on a combinatorial map",
         "K. Golec, M. Coquet, F. Zara, G. Damiand: Improvement of a Topological-Physical Model to "
         "manage different physical simulations. WSCG 2015, 25-34"},
        console);
  std::vector<const suture_model*> models;
  for (const ModelUse& use : scene.models)
    if (std::ranges::find(models, use.model) == models.end()) models.push_back(use.model);
  for (const suture_model* model : models)
    print({"model " + std::string(model->id) + " (plugin " + host.plugin_of(*model).id + ' ' +
               host.plugin_of(*model).version + ")",
           model->citation},
          console);
  for (const Reference& reference : references_of_solver(scene)) print(reference, console);
  for (const Reference& reference : references_of_contact(scene)) print(reference, console);
  const auto is_resisted = [](const Event& event) {
    const auto* blade = std::get_if<CutBlade>(&event.what);
    return blade != nullptr && blade->resistance.has_value();
  };
  if (std::ranges::any_of(scene.events, is_resisted))
    print({"force of a blade",
           "M. Mahvash, V. Hayward: Haptic rendering of cutting: a fracture mechanics approach. "
           "Haptics-e 2, 2001, 3"},
          console);
  if (scene.mesh.filled || std::ranges::any_of(scene.events, &Event::is_along_blade))
    print(
        {"elements of which only a part is material",
         "N. Molino, Z. Bao, R. Fedkiw: A virtual node algorithm for changing mesh topology during "
         "simulation. ACM Trans. Graph. 23, 2004, 385-392"},
        console);
  if (scene.mesh.filled && !scene.mesh.filled->labels.empty())
    print({"surface of a label image",
           "S. F. F. Gibson: Constrained elastic surface nets: generating smooth surfaces from "
           "binary segmented data. MICCAI 1998, 888-898; G. Taubin: A signal processing approach "
           "to fair surface design. SIGGRAPH 1995, 351-358"},
          console);
  const auto is_cubic = [](const Constraint& c) { return c.path.has_slopes(); };
  if (std::ranges::any_of(scene.constraints, is_cubic))
    print({"monotone cubic motion",
           "F. N. Fritsch, R. E. Carlson: Monotone piecewise cubic interpolation. SIAM J. Numer. "
           "Anal. 17, 1980, 238-246"},
          console);
  return 0;
}

}  // namespace suture
