#include "alidade/io/ros/containers/bags_module.h"

#include "alidade/base/error.h"
#include "alidade/io/ros/containers/open_bag.h"

extern "C" __attribute__((visibility("default"))) alidade::BagFile* alidade_bags_open(
    const std::vector<std::string>& paths, std::string* problem) try {
  return alidade::OpenBag(paths).release();
} catch (const alidade::Error& error) {
  *problem = error.what();
  return nullptr;
}
