// The registry as the compiler sees it. Here and not in pass/, because pass/ knows nothing of graphs.
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>

namespace weir {

graph::PassCatalog Registry::catalog() {
  graph::PassCatalog catalog;
  catalog.find = [this](const std::string& type) { return find(type); };
  catalog.types = [this] { return types(); };
  catalog.problem = [this](const std::string& type) { return problem(type); };
  return catalog;
}

}  // namespace weir
