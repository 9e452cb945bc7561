// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/frame.hpp"

namespace suture {

void FrameField::state(Archive& archive) {
  archive("name", name);
  archive("components", components);
  archive("values", values);
  archive("ids", ids);
  archive("global_ids", global_ids);
  archive("principal", principal);
}

void Frame::state(Archive& archive) {
  archive("number", number);
  archive("time", time);
  archive("points", points);
  archive("hexahedra", hexahedra);
  archive("tetrahedra", tetrahedra);
  archive("cells", cells);
  archive("is surface", is_surface);
  archive("point_fields", point_fields);
  archive("cell_fields", cell_fields);
  archive("provenance", field_data_provenance);
}

}  // namespace suture
