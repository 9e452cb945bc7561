// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/command_line.hpp"

#include <CLI/CLI.hpp>

#include "apps/suture/command_text.hpp"
#include "apps/suture/option_values.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/isa.hpp"
#include "suture/plugin.h"

namespace suture {
namespace {

std::string version_text() {
  const std::string isa(best_isa());
  return "suture " SUTURE_VERSION ", plugin interface " + std::to_string(SUTURE_ABI_MAJOR) + "." +
         std::to_string(SUTURE_ABI_MINOR) + ", instruction set " + (isa.empty() ? "base" : isa);
}

/// Checks the text of an option; an infinite number and NaN are refused, too.
CLI::Validator number(bool positive) {
  return {[positive](const std::string& text) { return why_no_number(text, positive); }, ""};
}
const CLI::Validator positive_number = number(true), number_from_0 = number(false);

CLI::Option* add_scene(CLI::App& app, std::filesystem::path& scene,
                       std::vector<std::string>& sets) {
  app.add_option("--set", sets,
                 "change a value of the scene, e.g. /solver/dt=1e-4; may be repeated")
      ->allow_extra_args(false)
      ->type_name("/PATH=VALUE");
  app.add_option_function<std::string>(
         "--threads",
         [&sets](const std::string& n) { sets.push_back("/solver/threads=" + thread_count(n)); },
         "the same as --set /solver/threads=N; 0 (default): as many as pay")
      ->type_name("N");
  return app.add_option("scene", scene, "scene file (JSON)")->required();
}

void add_skip(CLI::App& app, bool& skip) {
  app.add_flag("!--no-skip", skip,
               "also build and compute what the scene does not need (slower, same results)");
}

void add_number(CLI::App& app, const std::string& option, unsigned& number, unsigned least,
                unsigned most, const std::string& description) {
  app.add_option_function<std::string>(
         option,
         [=, &number](const std::string& n) { number = whole_number(option, n, least, most); },
         description)
      ->type_name("N");
}

void add_jobs(CLI::App& app, unsigned& jobs) {
  add_number(app, "--jobs", jobs, 1, 10000, "processes at once; default: one per core");
}

void add_plugin_checks(CLI::App& app, bool& check) {
  app.add_flag(
      "--check-plugins", check,
      "look for mistakes of plugins in every call of a force: values never set, writes "
      "outside arrays, results that are not finite; many times slower, hundreds of times on "
      "small scenes");
}

void add_trust(CLI::App& app, bool& trust) {
  app.add_flag("--trust", trust,
               "also load plugins that the scene names outside the search path, as `run` does");
}

std::string full_name(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return (parent == nullptr ? "" : full_name(*parent) + " ") + app.get_name();
}

OptionText text_of(const CLI::Option& option) {
  OptionText text{{}, "", "", option.get_description(), option.get_required()};
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  if (option.get_positional()) text.place = option.get_name(true);
  if (option.get_items_expected_max() > 0) text.value = option.get_type_name();
  return text;
}

CommandText text_of(const CLI::App& app) {
  CommandText text{full_name(app), app.get_description(), {}, {}};
  for (const CLI::Option* option : app.get_options()) text.options.push_back(text_of(*option));
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    text.commands.push_back(text_of(*below));
  return text;
}

/// The commands as CLI11 knows them; one of them is parsed.
struct Parser {
  CLI::App app{"Suture simulates soft bodies that are cut while they move."};
  CommandLine line;
  RunCommand run;
  LiveCommand live;
  CheckCommand check;
  CiteCommand cite;
  ExplainCommand explain;
  ReplayCommand replay;
  CheckModelCommand check_model;
  NewModelCommand new_model;
  NewSceneCommand new_scene;
  ModesCommand modes;
  SweepCommand sweep;
  FitCommand fit;
  CompareCommand compare;
  PlotCommand plot;
  DescribeCommand describe;
  MeshInfoCommand info;
  MeshConvertCommand convert;
  MeshBoxCommand box;
  MeshVoxelizeCommand voxels;
  MeshFillCommand fill;

  Parser() {
    app.name("suture");
    app.require_subcommand(1);
    app.fallthrough();
    app.set_version_flag("--version", version_text, "print the version");
    auto* quiet = app.add_flag("-q,--quiet", line.quiet, "warnings and errors only");
    app.add_flag("-v,--verbose", line.verbose, "print more messages")->excludes(quiet);
    add_scene_commands();
    add_model_commands();
    add_mesh_commands();
    add_texts();
    app.footer(notes_text());  // last: commands that are added later would repeat it
  }

 private:
  void add_scene_commands() {
    auto* new_app = app.add_subcommand("new-scene", "write a scene to start from");
    new_app->add_option("to", new_scene.to, "new file; default: beam.json");
    new_app->callback([this] { line.command = new_scene; });

    auto* run_app = app.add_subcommand("run", "run a scene, or repeat a recording of live");
    CLI::Option* scene = add_scene(*run_app, run.scene, run.sets);
    CLI::Option* resume =
        run_app
            ->add_option("--resume", run.resume,
                         "resume an earlier run from a checkpoint, in the same folder")
            ->type_name("CHECKPOINT")
            ->excludes(scene);
    scene->required(false)->excludes(resume);
    run_app
        ->add_option_function<std::string>(
            "-o,--output",
            [this](const std::string& d) { run.sets.push_back("/output/directory=" + d); },
            "the same as --set /output/directory=DIR")
        ->type_name("DIR");
    add_number(*run_app, "--processes", run.processes, 1, 10000,
               "processes that make the run together: the same as mpirun -n N suture run ...");
    add_skip(*run_app, run.skip);
    add_plugin_checks(*run_app, run.check_plugins);
    run_app->callback([this] {
      if (run.scene.empty() && run.resume.empty())
        throw CLI::RequiredError("a scene, or --resume CHECKPOINT,");
      line.command = run;
    });

    add_live(*app.add_subcommand("live", "run a scene, or continue a recording, in a browser"));

    auto* check_app = app.add_subcommand("check", "report every mistake in a scene");
    add_scene(*check_app, check.scene, check.sets);
    add_trust(*check_app, check.trust);
    add_plugin_checks(*check_app, check.check_plugins);
    check_app->callback([this] { line.command = check; });

    auto* explain_app =
        app.add_subcommand("explain", "show what a run would load, build, compute, skip and cost");
    add_scene(*explain_app, explain.scene, explain.sets);
    add_trust(*explain_app, explain.trust);
    explain_app->add_flag("--json", explain.json, "print JSON");
    add_skip(*explain_app, explain.skip);
    explain_app->callback([this] { line.command = explain; });

    auto* cite_app =
        app.add_subcommand("cite", "print the references of the models and methods of a scene");
    add_scene(*cite_app, cite.scene, cite.sets);
    add_trust(*cite_app, cite.trust);
    cite_app->callback([this] { line.command = cite; });

    add_sweep(*app.add_subcommand("sweep", "run a scene many times with other values"));
    add_fit(*app.add_subcommand("fit", "fit values of a scene to measured data"));
    add_modes(*app.add_subcommand("modes", "find natural frequencies and mode shapes"));

    add_compare(*app.add_subcommand("compare",
                                    "show how the results of two runs differ, or how "
                                    "three converge"));
    add_plot(*app.add_subcommand("plot", "draw runs, a study or a mesh as a picture"));

    auto* replay_app = app.add_subcommand(
        "replay",
        "replay the operations of a journal on its mesh, checking the map after each one, or a "
        "failed check of check-model");
    replay_app->add_option("file", replay.journal, "journal, or file that check-model wrote")
        ->required();
    add_trust(*replay_app, replay.trust);
    replay_app->callback([this] { line.command = replay; });
  }

  void add_live(CLI::App& sub) {
    add_scene(sub, live.scene, live.sets);
    add_number(sub, "--port", live.port, 0, 65535,
               "port on this machine; default: any that is free");
    sub.add_option(
           "--host", live.host,
           "address of this machine at which others may connect, 0.0.0.0 for all; who knows "
           "the printed address then controls the run, and nothing is encrypted; default: "
           "this machine only")
        ->type_name("ADDRESS");
    sub.add_option("-o,--output", live.recording,
                   "recording to write; default: SCENE-recording.jsonl, with the first input")
        ->type_name("FILE");
    CLI::Option* device =
        sub.add_option("--device", live.device,
                       "a thing in a hand, with what it takes: spacemouse, poses:PATH, FILE.so "
                       "(docs/live.md)")
            ->type_name("NAME[:ARGUMENT]");
    sub.add_option("--hold", live.hold,
                   "obstacle that the device moves; default: the first compliant one, or else what "
                   "its button 0 grasps")
        ->needs(device)
        ->type_name("OBSTACLE");
    sub.callback([this] { line.command = live; });
  }
  void add_sweep(CLI::App& sub) {
    sub.add_option("study", sweep.study,
                   "JSON file: scene, set, folder, output, jobs, and one of grid, list and "
                   "latin_hypercube (docs/python.md)")
        ->required();
    add_jobs(sub, sweep.jobs);
    sub.add_option("--slurm", sweep.slurm,
                   "write a job script for Slurm arrays and GNU parallel; run nothing")
        ->type_name("FILE");
    sub.callback([this] { line.command = sweep; });
  }
  void add_fit(CLI::App& sub) {
    sub.add_option("study", fit.study,
                   "JSON file: scene, set, fit, data, loss, stop, folder and jobs (docs/fit.md)")
        ->required();
    add_jobs(sub, fit.jobs);
    sub.callback([this] { line.command = fit; });
  }
  void add_compare(CLI::App& sub) {
    sub.add_option("runs", compare.runs,
                   "output folders of two runs, or their run.pvd; of three, from coarse to fine: "
                   "the observed orders of convergence")
        ->required()
        ->expected(2, 3)
        ->type_name("RUN");
    sub.add_flag("--common", compare.common,
                 "compare the frames of common times, where there are others");
    sub.add_option("--tolerance", compare.tolerance,
                   "end with exit code 1 if a relative difference of two runs is larger")
        ->check(number_from_0)
        ->type_name("T");
    sub.callback([this] { line.command = compare; });
  }
  void add_plot(CLI::App& sub) {
    sub.add_option("what", plot.what,
                   "output folders of runs; the folder or file of a study; a mesh, a surface or a "
                   "scene, whose mesh is drawn with its named sets and selections")
        ->required()
        ->type_name("WHAT");
    sub.add_option("-o,--output", plot.picture,
                   "picture to write, .png, .pdf or .svg (default: plot.png in the folder of a run "
                   "or study, else in the current one; NAME.png of a mesh)")
        ->type_name("FILE");
    sub.add_option("--only", plot.only,
                   "draw only columns whose names contain one of these texts, such as "
                   "displacement,force")
        ->delimiter(',')
        ->type_name("TEXT,...");
    sub.add_option("--set", plot.sets, "change a value of the scene; may be repeated")
        ->allow_extra_args(false)
        ->type_name("/PATH=VALUE");
    sub.add_option("--scale", plot.scale, "factor from the unit of a mesh or surface to m")
        ->check(positive_number);
    add_trust(sub, plot.trust);
    sub.callback([this] { line.command = plot; });
  }
  void add_modes(CLI::App& sub) {
    add_scene(sub, modes.scene, modes.sets);
    add_number(sub, "--count", modes.count, 1, 10000, "modes, the lowest first; default 10");
    sub.add_option_function<std::string>(
           "--at", [this](const std::string& at) { modes.at_equilibrium = is_equilibrium(at); },
           "the state about which the body vibrates: rest (default), or the static equilibrium at "
           "the end of the scene")
        ->type_name("rest|equilibrium");
    sub.add_option_function<std::string>(
           "-o,--output",
           [this](const std::string& d) {
             modes.sets.push_back("/output/directory=" + d);
             modes.names_folder = true;
           },
           "folder of the results; default: modes in the output folder of the scene")
        ->type_name("DIR");
    sub.callback([this] { line.command = modes; });
  }

  void add_model_commands() {
    app.add_subcommand("models", "list the models of all plugins found")->callback([this] {
      line.command = ModelsCommand{};
    });
    auto* describe_app =
        app.add_subcommand("describe", "show parameters, attributes and source of a model");
    describe_app->add_option("model", describe.model, "model id")->required();
    describe_app->callback([this] { line.command = describe; });
    app.add_subcommand("schema", "print a JSON schema of scenes with all models found, for editors")
        ->callback([this] { line.command = SchemaCommand{}; });
    add_new_model(*app.add_subcommand("new-model", "write a model of your own to start from"));
    add_check_model(*app.add_subcommand("check-model", "check a model against laws of physics"));
  }

  void add_new_model(CLI::App& sub) {
    sub.add_option("name", new_model.name, "id of the model, and name of its folder")->required();
    sub.add_option(
           "--kind,--level", new_model.level,
           "law: a solid, from its energy density (default); springs, nodes, faces: forces of "
           "edges, nodes, faces; field: an unknown on vertices; constraint: of each element; lips: "
           "between two regions; batches, c: eight cells at a time, in C++ or C")
        ->type_name("law|springs|nodes|faces|field|constraint|lips|batches|c");
    sub.add_option("-o,--output", new_model.output,
                   "folder to put it into; default: the current one")
        ->type_name("DIR");
    sub.callback([this] { line.command = new_model; });
  }
  void add_check_model(CLI::App& sub) {
    auto* model = sub.add_option("model", check_model.model, "model id or plugin file");
    sub.add_option("--only", check_model.only, "make these checks only")
        ->delimiter(',')
        ->type_name("CHECK,...");
    sub.add_option_function<std::vector<std::string>>(
           "--set",
           [this](const auto& all) {
             for (const auto& one : all) {
               auto [name, value] = named_value(one);
               check_model.sets[name] = std::move(value);
             }
           },
           "value of a parameter in all checks; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NAME=VALUE");
    sub.add_option("--seed", check_model.seed, "of what is chosen at random; default 1");
    sub.add_option("--timeout", check_model.timeout, "of one check, in s; default 60")
        ->check(positive_number);
    sub.add_option("-o,--output", check_model.output,
                   "folder for the files of failed checks; default: the current one")
        ->type_name("DIR");
    sub.add_flag("--json", check_model.json, "print JSON");
    sub.add_flag("--list", check_model.list, "list the checks");
    sub.callback([this, model] {
      if (!check_model.list && model->empty()) throw CLI::RequiredError("a model or plugin file,");
      line.command = check_model;
    });
  }
  void add_texts() {
    auto* completion = app.add_subcommand("completion", "print the completion of bash or zsh");
    completion->require_subcommand(1);
    const auto add = [this](CLI::App& to, const char* name, const char* help, auto&& make) {
      to.add_subcommand(name, help)->callback([this, make] {
        line.command = TextCommand{make(text_of(app))};
      });
    };
    add(*completion, "bash", "for bash", bash_completion);
    add(*completion, "zsh", "for zsh", zsh_completion);
    add(app, "man", "print the manual page, for man -l -",
        [](const CommandText& program) { return man_page(program, SUTURE_VERSION); });
  }

  void add_mesh_commands() {
    auto* mesh = app.add_subcommand("mesh", "inspect, convert and generate meshes");
    mesh->require_subcommand(1);
    const auto add_scale = [](CLI::App* sub, auto& scale) {
      sub->add_option("--scale", scale, "factor from the file's unit to m")->check(positive_number);
    };
    auto* info_app =
        mesh->add_subcommand("info", "print what a mesh, a surface or a label image contains");
    info_app
        ->add_option("file", info.file,
                     "mesh (.vtu .vtk .mesh .msh), surface (.obj .off .ply .stl .vtp) or image (" +
                         image_types + ")")
        ->required();
    add_scale(info_app, info.scale);
    info_app->callback([this] { line.command = info; });

    auto* convert_app = mesh->add_subcommand("convert", "convert a mesh to another file format");
    convert_app->add_option("from", convert.from, "mesh file")->required();
    convert_app->add_option("to", convert.to, "new file (.vtu .vtk .mesh .msh)")->required();
    add_scale(convert_app, convert.scale);
    convert_app->add_flag("--drop-bad", convert.drop_bad,
                          "leave out elements that are inverted or have the same point twice");
    convert_app->callback([this] { line.command = convert; });

    add_voxelize(*mesh->add_subcommand("voxelize", "fill a closed surface with equal cubes"));
    add_fill(*mesh->add_subcommand(
        "fill",
        "show how /mesh fills a closed surface, the shape of a mesh of tetrahedra or an image"));

    auto* generate = mesh->add_subcommand("generate", "generate a mesh");
    generate->require_subcommand(1);
    auto* box_app = generate->add_subcommand("box", "a regular or graded grid");
    box_app->add_option("to", box.to, "new file (.vtu .vtk .mesh .msh)")->required();
    box_app->add_option("--size", box.box.size, "lengths along x, y and z in m")->required();
    box_app->add_option("--cells", box.box.cells, "cells along x, y and z")->required();
    box_app->add_option("--origin", box.box.origin, "corner with the smallest coordinates, in m");
    box_app->add_option("--grading", box.box.grading, "last cell / first cell along x, y and z");
    for (CLI::Option* lengths : box_app->get_options()) lengths->delimiter(',');  // 1,1,1 or 1 1 1
    box_app->callback([this] { line.command = box; });
  }

  static inline const std::string image_types = ".nii .nii.gz .mha .mhd .nrrd .nhdr";
  static inline const std::string surface_file = "surface file (.obj .off .ply .stl .vtp)";
  /// What both commands take that fill a surface.
  template <class Command>
  static void add_filling(CLI::App& sub, Command& command, std::size_t& number, double& edge,
                          const std::string& input, const std::string& output) {
    sub.add_option("surface", command.from, input)->required();
    sub.add_option("-o,--output", command.to, "new file (" + output + ")")->required();
    auto* cells = sub.add_option("--cells", number, "approximate number of hexahedra, within 1 %")
                      ->check(positive_number);
    sub.add_option("--edge", edge, "edge length of the cubes in m")
        ->check(positive_number)
        ->excludes(cells);
    sub.add_option("--scale", command.scale, "factor from the file's unit to m")
        ->check(positive_number);
    sub.add_flag("--repair", command.repair, "fill holes and accept self-intersections");
  }

  void add_fill(CLI::App& sub) {
    add_filling(sub, fill, fill.size.cells, fill.size.edge,
                surface_file + ", mesh of solid cells (.vtu .vtk .mesh .msh) or label image (" +
                    image_types + ")",
                ".vtu, or .obj .off .ply .stl");
    sub.add_option_function<std::vector<std::string>>(
           "--label",
           [this](const auto& texts) {
             for (const std::string& text : texts) {
               auto [label, name] = named_label(text);
               fill.labels[label] = std::move(name);
             }
           },
           "a region of an image, such as 1=liver; may be repeated (default: all labels but 0)")
        ->type_name("N=NAME")
        ->take_all();
    sub.callback([this] { line.command = fill; });
  }

  void add_voxelize(CLI::App& sub) {
    add_filling(sub, voxels, voxels.options.cells, voxels.options.edge, surface_file,
                ".vtu .vtk .mesh .msh");
    sub.add_flag("--largest-island", voxels.options.largest_island,
                 "keep only the largest connected part");
    sub.callback([this] { line.command = voxels; });
  }
};

// The innermost command that was given.
const CLI::App& innermost(const CLI::App& app) {
  const auto given = app.get_subcommands();
  return given.empty() ? app : innermost(*given.front());
}

// CLI11 knows that a word is one too many; we know what was meant by it.
[[noreturn]] void fail_with_word(const CLI::App& app, const std::string& word) {
  const CLI::App& command = innermost(app);
  std::vector<OptionText> around;
  for (const CLI::App* a = command.get_parent(); a != nullptr; a = a->get_parent())
    for (OptionText& option : text_of(*a).options) around.push_back(std::move(option));
  fail_with_word(text_of(command), around, word);
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Parser parser;
  if (argc < 2) return {.command = TextCommand{guide_text(parser.app.get_description())}};
  try {
    parser.app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    for (const std::string& word : parser.app.remaining(true)) fail_with_word(parser.app, word);
    return {.command = TextCommand{innermost(parser.app).help()}};
  } catch (const CLI::CallForVersion& version) {
    return {.command = TextCommand{std::string(version.what()) + "\n"}};
  } catch (const BadValue& error) {
    throw UsageError(full_name(innermost(parser.app)) + ": " + error.what());
  } catch (const CLI::ConversionError& error) {
    throw UsageError(full_name(innermost(parser.app)) + ": " + error.what());
  } catch (const CLI::ParseError& error) {
    // With a word too many, CLI11 may complain of something that follows from it.
    for (const std::string& word : parser.app.remaining(true)) fail_with_word(parser.app, word);
    throw UsageError(full_name(innermost(parser.app)) + ": " + error.what());
  }
  return parser.line;
}

}  // namespace suture
