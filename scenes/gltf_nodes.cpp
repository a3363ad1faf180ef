#include "scenes/gltf_nodes.hpp"

#include <cmath>
#include <glm/geometric.hpp>

namespace nephroid::scenes::gltf {
namespace {

std::string node_label(const tinygltf::Model& model, int node) {
    return label("node", static_cast<std::size_t>(node), model.nodes[static_cast<std::size_t>(node)].name);
}

// Translation times rotation times scale. A quaternion q turns by the matrix of q / |q|, and dividing its products by
// |q|^2 needs no square root.
glm::dmat4 from_translation_rotation_scale(const tinygltf::Node& node, const std::string& object, const Context& context) {
    glm::dmat4 matrix(1.0);
    if (!node.rotation.empty()) {
        const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
        const double square = x * x + y * y + z * z + w * w;
        const double s = 2.0 / square;
        if (!(square > 0.0) || !std::isfinite(s) || !std::isfinite(square))
            context.refuse(object, "its rotation is not a quaternion that can be given unit length");
        matrix[0] = {1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0.0};
        matrix[1] = {s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w), 0.0};
        matrix[2] = {s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y), 0.0};
    }
    for (int k = 0; k < 3; ++k) {
        if (!node.scale.empty()) matrix[k] *= node.scale[static_cast<std::size_t>(k)];
        if (!node.translation.empty()) matrix[3][k] = node.translation[static_cast<std::size_t>(k)];
    }
    return matrix;
}

glm::dmat4 parent_from_node(const tinygltf::Model& model, int index, const Context& context) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const std::string object = node_label(model, index);
    if (node.matrix.empty()) return from_translation_rotation_scale(node, object, context);
    glm::dmat4 matrix;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix[column][row] = node.matrix[static_cast<std::size_t>(4 * column + row)];
    if (matrix[0].w != 0.0 || matrix[1].w != 0.0 || matrix[2].w != 0.0 || matrix[3].w != 1.0)
        context.refuse(object, "the last row of its matrix is not 0 0 0 1");
    return matrix;
}

bool is_finite(const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(matrix[column][row])) return false;
    return true;
}

// Every node's parent, or -1. With one parent each, a node is its own ancestor only on a ring without a root.
std::vector<int> find_parents(const tinygltf::Model& model, const Context& context) {
    std::vector<int> parents(model.nodes.size(), -1);
    for (std::size_t node = 0; node < model.nodes.size(); ++node) {
        for (const int child : model.nodes[node].children) {
            int& parent = parents[static_cast<std::size_t>(child)];
            if (parent >= 0)
                context.refuse(node_label(model, child),
                               "it is the child of both node " + std::to_string(parent) + " and node " + std::to_string(node));
            parent = static_cast<int>(node);
        }
    }
    std::vector<std::size_t> seen_by(model.nodes.size(), model.nodes.size());
    for (std::size_t start = 0; start < model.nodes.size(); ++start) {
        for (int node = static_cast<int>(start); node >= 0; node = parents[static_cast<std::size_t>(node)]) {
            std::size_t& seen = seen_by[static_cast<std::size_t>(node)];
            if (seen == start) context.refuse(node_label(model, node), "it is its own ancestor");
            if (seen != model.nodes.size()) break;
            seen = start;
        }
    }
    return parents;
}

// The unit vector along v, for the axes of cameras and lights.
glm::dvec3 axis(const glm::dvec3& v, const std::string& object, const Context& context) {
    const double length = std::sqrt(glm::dot(v, v));
    if (!(length > 0.0) || !std::isfinite(length)) context.refuse(object, "its transform leaves it no direction");
    return v / length;
}

glm::vec3 place_of(const PlacedNode& placed, const std::string& object, const Context& context) {
    const glm::dvec3 position(placed.world_from_node[3]);
    for (int k = 0; k < 3; ++k)
        if (!(std::abs(position[k]) <= context.limits.world_extent)) context.refuse(object, "it stands farther than 1e12 m out");
    return glm::vec3(position);
}

}  // namespace

std::vector<PlacedNode> place_nodes(const tinygltf::Model& model, Context& context) {
    const std::vector<int> parents = find_parents(model, context);
    std::vector<int> roots;
    if (!model.scenes.empty()) {
        roots = model.scenes[static_cast<std::size_t>(model.defaultScene < 0 ? 0 : model.defaultScene)].nodes;
    } else {
        for (std::size_t node = 0; node < parents.size(); ++node)
            if (parents[node] < 0) roots.push_back(static_cast<int>(node));
    }

    struct Pending {
        int node;
        std::size_t depth;
        glm::dmat4 world_from_parent;
    };
    std::vector<Pending> stack;
    for (std::size_t k = roots.size(); k-- > 0;) stack.push_back({roots[k], 1, glm::dmat4(1.0)});
    std::vector<char> visited(model.nodes.size(), 0);
    std::vector<PlacedNode> placed;
    while (!stack.empty()) {
        const Pending pending = stack.back();
        stack.pop_back();
        const std::string object = node_label(model, pending.node);
        char& was_visited = visited[static_cast<std::size_t>(pending.node)];
        if (was_visited) context.refuse(object, "the scene lists it twice, or lists it beside its parent");
        was_visited = 1;
        if (pending.depth > context.limits.node_depth)
            context.refuse(object, "it lies deeper than " + std::to_string(context.limits.node_depth) + " nodes");
        const glm::dmat4 world = pending.world_from_parent * parent_from_node(model, pending.node, context);
        if (!is_finite(world)) context.refuse(object, "its world matrix is not finite");
        placed.push_back({pending.node, world});
        const std::vector<int>& children = model.nodes[static_cast<std::size_t>(pending.node)].children;
        for (std::size_t k = children.size(); k-- > 0;) stack.push_back({children[k], pending.depth + 1, world});
    }
    return placed;
}

Camera read_camera(const tinygltf::Model& model, const PlacedNode& placed, Context& context) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
    const tinygltf::Camera& source = model.cameras[static_cast<std::size_t>(node.camera)];
    const std::string object = label("camera", static_cast<std::size_t>(node.camera), source.name);
    Camera camera;
    camera.name = one_line(node.name.empty() ? source.name : node.name);
    if (source.type == "perspective") {
        const tinygltf::PerspectiveCamera& perspective = source.perspective;
        if (!(perspective.yfov < 3.14159)) context.refuse(object, "yfov must be less than pi");
        camera.vertical_fov = static_cast<float>(perspective.yfov);
        camera.aspect = static_cast<float>(perspective.aspectRatio);
        camera.near_plane = static_cast<float>(perspective.znear);
        if (perspective.zfar > 0.0) camera.far_plane = static_cast<float>(perspective.zfar);
        if (!(camera.near_plane > 0.0f && camera.near_plane < camera.far_plane)) context.refuse(object, "zfar must be greater than znear");
    } else {
        context.note("Orthographic cameras are not drawn: " + object + " became a perspective one at the same place.");
    }

    // Straight axes, z first (a camera looks along -z), however the node is scaled or sheared.
    const glm::dvec3 back = axis(glm::dvec3(placed.world_from_node[2]), object, context);
    const glm::dvec3 node_up(placed.world_from_node[1]);
    const glm::dvec3 right = axis(glm::cross(node_up, back), object, context);
    const glm::dvec3 up = glm::cross(back, right);
    camera.world_from_camera = glm::mat4(glm::vec4(glm::vec3(right), 0.0f), glm::vec4(glm::vec3(up), 0.0f),
                                         glm::vec4(glm::vec3(back), 0.0f), glm::vec4(place_of(placed, object, context), 1.0f));
    return camera;
}

int light_of(const tinygltf::Node& node) {
    const auto it = node.extensions.find("KHR_lights_punctual");
    return it == node.extensions.end() ? -1 : it->second.Get("light").GetNumberAsInt();
}

Light read_light(const tinygltf::Model& model, const PlacedNode& placed, int index, Context& context) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(placed.node)];
    const tinygltf::Light& source = model.lights[static_cast<std::size_t>(index)];
    const std::string object = label("light", static_cast<std::size_t>(index), source.name);
    Light light;
    light.name = one_line(node.name.empty() ? source.name : node.name);
    light.position = place_of(placed, object, context);
    for (int k = 0; k < 3; ++k) {
        const double color = source.color.empty() ? 1.0 : source.color[static_cast<std::size_t>(k)];
        if (color < 0.0) context.refuse(object, "color must not be negative");
        light.intensity[k] = static_cast<float>(color * source.intensity);
        if (!std::isfinite(light.intensity[k])) context.refuse(object, "color times intensity is beyond the range of a float");
    }
    if (source.range > 0.0) light.range = static_cast<float>(source.range);
    if (source.type == "directional") light.type = LightType::Directional;
    if (source.type == "spot") {
        light.type = LightType::Spot;
        constexpr double right_angle = 1.5707963267948966;
        double inner = source.spot.innerConeAngle, outer = source.spot.outerConeAngle;
        if (outer > right_angle) {
            context.note("The outer cone of " + object + " was clamped to a right angle.");
            outer = right_angle;
        }
        if (inner > outer) context.refuse(object, "innerConeAngle must not exceed outerConeAngle");
        light.inner_cone = static_cast<float>(inner);
        light.outer_cone = static_cast<float>(outer);
    }
    if (light.type != LightType::Point) light.direction = glm::vec3(axis(-glm::dvec3(placed.world_from_node[2]), object, context));
    return light;
}

}  // namespace nephroid::scenes::gltf
