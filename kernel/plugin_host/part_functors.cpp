// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/plugin_host/part_functors.hpp"

#include <map>

#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/plugin_host/table_entry.hpp"

namespace suture {

const suture_attribute& cell_attribute(const suture_model& model, std::uint32_t place) {
  constexpr auto made = [](std::uint32_t components) {
    return suture_attribute{sizeof(suture_attribute),
                            3,
                            components,
                            SUTURE_COPY,
                            SUTURE_INTERNAL,
                            0,
                            "part",
                            "1",
                            "The part of an element that is material",
                            0,
                            nullptr,
                            0,
                            0};
  };
  static constexpr suture_attribute part = made(SUTURE_PART_COMPONENTS),
                                    general = made(SUTURE_GENERAL_PART_COMPONENTS);
  return place == SUTURE_PART_COLUMN           ? part
         : place == SUTURE_GENERAL_PART_COLUMN ? general
                                               : model.attributes[place];
}

const char* parts_extension(const suture_functor& functor) {
  return functor.shape == SUTURE_GENERAL ? SUTURE_PARTS_2 : SUTURE_PARTS_1;
}

bool allows_parts(const suture_functor& functor) {
  return extension_of<suture_parts_1>(functor, parts_extension(functor)) != nullptr;
}

const suture_functor* functor_on_parts(const suture_functor& functor) {
  static std::map<const suture_functor*, suture_functor> kept;
  const auto* table = extension_of<suture_parts_1>(functor, parts_extension(functor));
  if (table == nullptr || table->functor == nullptr) return nullptr;
  suture_functor& copy = kept[table->functor];
  copy =
      copy_of<suture_functor>(reinterpret_cast<const char*>(table->functor), table->functor->size);
  return &copy;
}

}  // namespace suture
