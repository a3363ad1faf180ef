// Files beside the glTF are read; nothing else is.
#include <doctest/doctest.h>

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "scenes/load.hpp"
#include "tests/scenes/glb_builder.hpp"

using namespace nephroid;
using namespace nephroid::scenes;
using nephroid::test::GlbBuilder;
using nephroid::test::json;
using nephroid::test::one;
using nephroid::test::refusal;

namespace fs = std::filesystem;

namespace {

// outer/secret.bin, outer/inner/scene.gltf, outer/inner/parts/mesh data+1.bin and links.
struct Folders {
    fs::path outer = fs::temp_directory_path() / ("nephroid_files_test_" + std::to_string(std::rand())), inner = outer / "inner";
    GlbBuilder triangle = GlbBuilder::triangle();

    Folders() {
        fs::create_directories(inner / "parts");
        for (const fs::path& path : {outer / "secret.bin", inner / "mesh.bin", inner / "parts" / "mesh data+1.bin"})
            write(path, triangle.binary.size() + 3);
        fs::create_symlink(outer / "secret.bin", inner / "way out.bin");
        fs::create_symlink(inner / "mesh.bin", inner / "way in.bin");
        fs::create_directory_symlink(outer, inner / "up");
    }
    ~Folders() { fs::remove_all(outer); }
    // More bytes than byteLength says are allowed.
    void write(const fs::path& path, std::size_t size) const {
        std::ofstream out(path, std::ios::binary);
        out.write(reinterpret_cast<const char*>(triangle.binary.data()),
                  static_cast<std::streamsize>(std::min(size, triangle.binary.size())));
        for (std::size_t k = triangle.binary.size(); k < size; ++k) out.put('x');
    }
    std::string gltf(const std::string& uri) const {
        json root = triangle.root;
        root["buffers"] = one({{"byteLength", triangle.binary.size()}, {"uri", uri}});
        return root.dump();
    }
    std::string refusal_of(const std::string& uri) const { return refusal(test::as_bytes(gltf(uri)), inner); }
};

std::string line_of(const std::string& path) {
    try {
        static_cast<void>(load_scene(path));
    } catch (const SceneError& error) {
        return error.what();
    }
    return "read";
}

}  // namespace

TEST_CASE("buffers in files beside the glTF and below it") {
    const Folders folders;
    for (const char* uri :
         {"mesh.bin", "./mesh.bin", "parts/mesh data+1.bin", "parts/mesh%20data+1.bin", "parts/mesh%20data%2b1.bin", "way in.bin"}) {
        CAPTURE(uri);
        CHECK(folders.refusal_of(uri) == "read");
    }
    std::ofstream(folders.inner / "scene.gltf") << folders.gltf("parts/mesh%20data+1.bin");
    const Scene scene = load_scene((folders.inner / "scene.gltf").string());
    CHECK(scene.name == "scene");
    CHECK(scene.meshes[0].positions[1] == glm::vec3(1, 0, 0));
    // From its own folder as well, by bare name.
    const fs::path before = fs::current_path();
    fs::current_path(folders.inner);
    CHECK(line_of("scene.gltf") == "read");
    fs::current_path(before);
}

TEST_CASE("refused: ways out of the glTF's folder") {
    const Folders folders;
    const auto check = [&](const std::string& uri, const std::string& rule) {
        CHECK(folders.refusal_of(uri) == "test.glb: buffer 0: its uri \"" + uri + "\" " + rule);
    };
    const std::string leads_out = "leads out of the glTF's folder";
    check("../secret.bin", leads_out);
    check("parts/../../secret.bin", leads_out);
    check("parts/../mesh.bin", leads_out);  // even where it comes back: no file needs this
    check("%2e%2e/secret.bin", leads_out);
    check("..%2fsecret.bin", leads_out);
    check("way out.bin", leads_out);
    check("up/secret.bin", leads_out);
    check("/etc/passwd", "is an absolute path");
    check("%2Fetc/passwd", "is an absolute path");
    check("file:///etc/passwd", "is a URL; only files beside the glTF are read");
    check("http://example.com/mesh.bin", "is a URL; only files beside the glTF are read");
    check("C:/mesh.bin", "is a URL; only files beside the glTF are read");
    check("..\\secret.bin", "holds a backslash or a zero byte");
    check("mesh.bin%00.png", "holds a backslash or a zero byte");
    CHECK(folders.refusal_of("") == "test.glb: buffer 0: its uri is empty");
    CHECK(folders.refusal_of("none.bin") == "test.glb: buffer 0: no such file: none.bin");
    CHECK(folders.refusal_of("parts") == "test.glb: buffer 0: not a regular file: parts");
}

TEST_CASE("without a folder no file is read") {
    const Folders folders;
    CHECK(refusal(test::as_bytes(folders.gltf("mesh.bin"))) ==
          "test.glb: buffer 0: its uri \"mesh.bin\" names a file, and files are not read here");
}

TEST_CASE("refused: files too short, too long, or without end") {
    const Folders folders;
    folders.write(folders.inner / "short.bin", 77);
    CHECK(folders.refusal_of("short.bin") == "test.glb: buffer 0: it has 77 bytes, byteLength says 78");
    Limits limits;
    limits.total_bytes = 80;
    CHECK(refusal(test::as_bytes(folders.gltf("mesh.bin")), folders.inner, limits) ==
          "test.glb: buffer 0: buffers and images together have more than 80 bytes");
    folders.write(folders.inner / "long.bin", 3000);
    limits = {};
    limits.file_bytes = 2999;
    CHECK(refusal(test::as_bytes(folders.gltf("long.bin")), folders.inner, limits) ==
          "test.glb: buffer 0: the file is larger than 2999 bytes");
    // A pipe: opening it would wait for ever.
    REQUIRE(mkfifo((folders.inner / "pipe.bin").c_str(), 0600) == 0);
    CHECK(folders.refusal_of("pipe.bin") == "test.glb: buffer 0: not a regular file: pipe.bin");
    // A hole of three gigabytes.
    std::ofstream(folders.inner / "huge.glb").put('g');
    fs::resize_file(folders.inner / "huge.glb", 3ull << 30);
    CHECK(line_of((folders.inner / "huge.glb").string()) ==
          (folders.inner / "huge.glb").string() + ": the file is larger than 2147483647 bytes");
}

TEST_CASE("media from a file of their own") {
    const Folders folders;
    const fs::path path = folders.outer / "fog.json";
    const auto set = [&](const std::string& text) {
        std::ofstream(path) << text;
        Scene scene = bundled_scene("glass-sphere");
        try {
            set_media(scene, path.string());
        } catch (const SceneError& error) {
            return error.object() + ": " + error.rule();
        }
        return std::to_string(scene.media.size()) + " of " + std::to_string(scene.media.back().sigma_s.r);
    };
    CHECK(set(R"({"medium": {"sigma_s": 0.5}})") == "1 of 0.500000");
    CHECK(set(R"({"media": [{"sigma_s": 0.5}, {"sigma_s": 2, "inside": "sphere"}]})") == "2 of 2.000000");
    CHECK(set(R"({"medium": {"inside": "cube"}})") == "medium: it is inside \"cube\", and no node with a mesh has that name");
    CHECK(set(R"({"medium": {"sigma_s": "thick"}})") == "file medium: sigma_s must be a number");
    CHECK(set(R"({"fog": {}})") == "JSON: it holds neither medium nor media");
    CHECK(set("{") == "JSON: it must be an object, {\"medium\": {...}} or {\"media\": [...]}");
    CHECK(set(std::string(1000, '[')) == "JSON: brackets are nested deeper than 100");
}

TEST_CASE("a bundled name, a file, or a line that says what there is") {
    CHECK(load_scene("prism").name == "prism");
    CHECK(line_of("prisms") ==
          "prisms: there is no such file, nor a bundled scene of this name (glass-sphere, mirror-ring, pool, glass-torus, sphere-in-fog, "
          "sphere-above-water, prism, wine-glass, closed-box, refractor-room)");
    CHECK(line_of("/") == "/: not a regular file");
}
