#include "render/scene/io/mesh_objects.h"

#include <assimp/scene.h>

#include <map>
#include <set>
#include <utility>

namespace foci {
namespace {

/// A name as a field of a table: no tab, no line break.
std::string fieldOf(const aiString& name) {
  std::string text = name.C_Str();
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

class Objects {
 public:
  explicit Objects(const aiScene& scene) {
    found_.of.resize(scene.mNumMeshes, 0);
    found_.names = {""};
  }

  /// The number of a new object. Names that are taken get a number.
  std::uint16_t add(const std::string& name) {
    if (found_.names.size() > kMaxObjects) return 0;
    std::string unique = name;
    for (int i = 2; !taken_.insert(unique).second; ++i) {
      unique = name + " (" + std::to_string(i) + ")";
    }
    found_.names.push_back(unique);
    return static_cast<std::uint16_t>(found_.names.size() - 1);
  }

  /// @param above  the nearest name above the node
  void addNodes(const aiNode& node, const std::string& above) {
    const std::string own = fieldOf(node.mName);
    const std::string& name = own.empty() ? above : own;
    if (node.mNumMeshes > 0) {
      const std::uint16_t object = add(name.empty() ? "unnamed" : name);
      for (unsigned m = 0; m < node.mNumMeshes; ++m) found_.of[node.mMeshes[m]] = object;
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) addNodes(*node.mChildren[c], name);
  }

  void addMaterials(const aiScene& scene) {
    std::map<unsigned, std::uint16_t> of_material;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
      const unsigned material = scene.mMeshes[m]->mMaterialIndex;
      if (material >= scene.mNumMaterials) continue;
      const auto [at, is_new] = of_material.emplace(material, std::uint16_t{0});
      if (is_new) {
        const std::string name = fieldOf(scene.mMaterials[material]->GetName());
        at->second = add(name.empty() ? "unnamed" : name);
      }
      found_.of[m] = at->second;
    }
  }

  std::size_t count() const { return found_.names.size() - 1; }
  SceneObjects take() { return std::move(found_); }

 private:
  SceneObjects found_;
  std::set<std::string> taken_;
};

}  // namespace

SceneObjects objectsOf(const aiScene& scene) {
  Objects nodes(scene);
  if (scene.mRootNode != nullptr) nodes.addNodes(*scene.mRootNode, "");
  if (nodes.count() > 1) return nodes.take();
  Objects materials(scene);
  materials.addMaterials(scene);
  return materials.count() > 1 ? materials.take() : SceneObjects{};
}

}  // namespace foci
