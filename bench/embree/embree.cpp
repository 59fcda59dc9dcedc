// Embree on two meshes in one frame: build and refit of a tree of triangles, and the pairs of faces whose boxes overlap.
//
//     g++ -O3 -march=native embree.cpp -o embree -lembree3
//     embree VERTICES_A VERTICES_B FACES REPEATS
//
// Vertices are files of float32 triples and faces one of uint32 triples, little endian. What is measured is printed as JSON.
// rtcCollide takes user geometries alone: the boxes of the faces, whose bounds a callback gives; a callback counts the pairs.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <embree3/rtcore.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

using Vertices = std::vector<float>;
using Faces = std::vector<uint32_t>;

template <class T> static std::vector<T> read(const char* path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        std::fprintf(stderr, "cannot read %s\n", path);
        std::exit(2);
    }
    std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

static double seconds(const std::function<void()>& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Mesh {
    const Vertices& vertices;
    const Faces& faces;
};

static RTCGeometry triangles(RTCDevice device, const Mesh& mesh, RTCBuildQuality quality) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size() / 3);
    std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * 4);
    void* faces = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.faces.size() / 3);
    std::memcpy(faces, mesh.faces.data(), mesh.faces.size() * 4);
    return geometry;
}

static double build(RTCDevice device, const Mesh& mesh) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = triangles(device, mesh, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    const double time = seconds([&] { rtcCommitScene(scene); });
    rtcReleaseScene(scene);
    return time;
}

static std::vector<double> refits(RTCDevice device, const Mesh& mesh, int repeats) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW); // a tree for each geometry, without which none is refitted
    RTCGeometry geometry = triangles(device, mesh, RTC_BUILD_QUALITY_REFIT);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) {
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        times.push_back(seconds([&] {
            rtcCommitGeometry(geometry);
            rtcCommitScene(scene);
        }));
    }
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    return times;
}

static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const Mesh& mesh = *static_cast<const Mesh*>(arguments->geometryUserPtr);
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int corner = 0; corner < 3; ++corner) {
        const float* vertex = &mesh.vertices[3 * mesh.faces[3 * arguments->primID + corner]];
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], vertex[axis]);
            high[axis] = std::max(high[axis], vertex[axis]);
        }
    }
    RTCBounds& box = *arguments->bounds_o;
    box.lower_x = low[0], box.lower_y = low[1], box.lower_z = low[2];
    box.upper_x = high[0], box.upper_y = high[1], box.upper_z = high[2];
}

static RTCScene boxes(RTCDevice device, Mesh& mesh) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, mesh.faces.size() / 3);
    rtcSetGeometryUserData(geometry, &mesh);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

static void count(void* total, RTCCollision*, unsigned int found) { *static_cast<size_t*>(total) += found; }

static void print(const char* name, const std::vector<double>& times, const char* end) {
    std::printf("\"%s\": [", name);
    for (size_t i = 0; i < times.size(); ++i) std::printf("%s%.9g", i ? ", " : "", times[i]);
    std::printf("]%s", end);
}

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: %s VERTICES_A VERTICES_B FACES REPEATS\n", argv[0]);
        return 2;
    }
    const Vertices vertices_a = read<float>(argv[1]), vertices_b = read<float>(argv[2]);
    const Faces faces = read<uint32_t>(argv[3]);
    const int repeats = std::atoi(argv[4]);
    Mesh a{vertices_a, faces}, b{vertices_b, faces};
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");

    std::vector<double> builds, collisions;
    for (int i = 0; i < repeats; ++i) builds.push_back(build(device, a));
    const std::vector<double> refit = refits(device, a, repeats);
    RTCScene scene_a = boxes(device, a), scene_b = boxes(device, b);
    size_t pairs = 0;
    for (int i = 0; i < repeats; ++i) {
        pairs = 0;
        collisions.push_back(seconds([&] { rtcCollide(scene_a, scene_b, count, &pairs); }));
    }
    std::printf("{\"box_pairs\": %zu, ", pairs);
    print("build_seconds", builds, ", ");
    print("refit_seconds", refit, ", ");
    print("collide_seconds", collisions, "}\n");
    rtcReleaseScene(scene_a);
    rtcReleaseScene(scene_b);
    rtcReleaseDevice(device);
}
