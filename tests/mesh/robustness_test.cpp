// SPDX-License-Identifier: GPL-3.0-or-later
//
// Truncated or damaged files give one InputError, or a mesh with valid indices; never a crash, and
// never an allocation for an invalid count.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/mesh/vtk_files.hpp"

namespace suture {
namespace {

// SUTURE_FULL=1: 20,000 damaged files per format; else a sample of 500. The seed
// is printed, and taken from SUTURE_SEED if that is set.
int trials() { return std::getenv("SUTURE_FULL") ? 20000 : 500; }
unsigned seed() {
  const char* given = std::getenv("SUTURE_SEED");
  return given ? unsigned(std::strtoul(given, nullptr, 10)) : std::random_device{}();
}

struct Sample {
  std::string name, text;
};

std::vector<Sample> samples() {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  Mesh mesh = make_box({.cells = {2, 2, 2}});
  mesh.element_sets["half"] = {0, 1, 2, 3};
  mesh.point_ids.assign(mesh.points.size(), 0);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) mesh.point_ids[i] = 10 + i;
  std::vector<Sample> all;
  const auto add = [&](const std::string& name) {
    all.push_back({name, read_text(folder / name)});
  };
  for (const char* name : {"m.mesh", "m.msh", "m.vtk", "m.vtu"}) {
    write_mesh(folder / name, mesh, diagnostics);
    add(name);
  }
  int number = 0;
  for (const VtkEncoding encoding : vtk_encodings) {
    const bool legacy =
        encoding == VtkEncoding::legacy_text || encoding == VtkEncoding::legacy_binary;
    const std::string name = "vtk" + std::to_string(number++) + (legacy ? ".vtk" : ".vtu");
    write_with_vtk(folder / name, mesh, encoding);
    add(name);
  }
  for (const char* name :
       {"two_msh22.msh", "two_msh22_binary.msh", "two_msh41.msh", "two_msh41_binary.msh"}) {
    all.push_back({name, read_text(std::filesystem::path(SUTURE_TEST_DATA) / name)});
  }
  return all;
}

// True if the file was read; fails the test for anything but a mesh or an InputError.
bool survives(const std::filesystem::path& path) {
  Diagnostics diagnostics;
  try {
    const Mesh mesh = read_mesh(path, 1, diagnostics);
    for (const Hexahedron& nodes : mesh.hexahedra) {
      for (const Index node : nodes) EXPECT_LT(node, mesh.points.size());
    }
    for (const Vec3& x : mesh.points) EXPECT_TRUE(std::isfinite(x[0] + x[1] + x[2]));
    for (const auto& [name, members] : mesh.element_sets) {
      for (const Index e : members) EXPECT_LT(e, mesh.hexahedra.size()) << name;
    }
    return true;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos)
        << error.what();
    return false;
  }
}

// 4 GB of address space: what a damaged count asks for fails as std::bad_alloc.
// Sanitizers map terabytes for themselves.
class Robustness : public testing::Test {
 protected:
  Robustness() {
    ::getrlimit(RLIMIT_AS, &before_);
    rlimit small = before_;
    small.rlim_cur = rlim_t{4} << 30;
    if (test::sanitizer.empty()) ::setrlimit(RLIMIT_AS, &small);
  }
  ~Robustness() override { ::setrlimit(RLIMIT_AS, &before_); }
  rlimit before_{};
};

TEST_F(Robustness, TruncatedFiles) {
  const TemporaryFolder folder;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.name);
    const std::size_t step =
        std::getenv("SUTURE_FULL") ? 1 : std::max<std::size_t>(1, sample.text.size() / 150);
    std::size_t read = 0;
    for (std::size_t size = 0; size < sample.text.size(); size += step) {
      const auto path = folder.write(sample.name, std::string_view(sample.text).substr(0, size));
      // What is lost may be a line feed or arrays behind the cells, no more.
      if (survives(path)) {
        ++read;
        Diagnostics diagnostics;
        EXPECT_GE(read_mesh(path, 1, diagnostics).hexahedra.size(), 2u);
      }
      if (testing::Test::HasFailure()) FAIL() << "cut off at byte " << size;
    }
    EXPECT_LT(read * step, sample.text.size() / 2);
  }
}

TEST_F(Robustness, DamagedFiles) {
  const unsigned first = seed();
  std::printf("SUTURE_SEED=%u\n", first);
  const TemporaryFolder folder;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.name + ", seed " + std::to_string(first));
    std::mt19937_64 random(first);
    for (int trial = 0; trial < trials(); ++trial) {
      std::string text = sample.text;
      for (std::size_t n = 1 + random() % 4; n > 0; --n) {
        const std::size_t at = random() % text.size();
        switch (random() % 4) {
          case 0:
            text[at] = static_cast<char>(random());
            break;
          case 1:
            text[at] = "0123456789 -.e\n"[random() % 15];
            break;
          case 2:
            text.insert(at, std::string(1 + random() % 3, '9'));
            break;
          default:
            text.erase(at, 1 + random() % 8);
            break;
        }
        if (text.empty()) text = "x";
      }
      survives(folder.write(sample.name, text));
      if (testing::Test::HasFailure()) FAIL() << "trial " << trial;
    }
  }
}

TEST_F(Robustness, NoiseUnderEveryExtension) {
  const unsigned first = seed();
  std::printf("SUTURE_SEED=%u\n", first);
  std::mt19937_64 random(first);
  const TemporaryFolder folder;
  for (const char* name : {"n.mesh", "n.msh", "n.vtk", "n.vtu", "n"}) {
    for (int trial = 0; trial < 50; ++trial) {
      std::string noise(random() % 2000, '\0');
      for (char& c : noise) c = static_cast<char>(random());
      EXPECT_FALSE(survives(folder.write(name, noise))) << name << " seed " << first;
    }
  }
}

}  // namespace
}  // namespace suture
