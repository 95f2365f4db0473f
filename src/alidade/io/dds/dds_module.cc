#include "alidade/io/dds/dds_module.h"

#include <exception>
#include <memory>

#include "alidade/io/dds/dds_node.h"

extern "C" __attribute__((visibility("default"))) alidade::DdsNode* alidade_dds_join(
    const alidade::DdsDomain& domain, const std::string& name, std::string* problem) try {
  return std::make_unique<alidade::CycloneNode>(domain, name).release();
} catch (const std::exception& error) {
  *problem = error.what();
  return nullptr;
}
