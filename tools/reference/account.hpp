// Where light went.
#pragma once
#include "tools/reference/vector.hpp"

namespace nephroid::reference {

// Where the photons' flux went, W. emitted + correction = deposited + absorbed + escaped + truncated, up to the noise of
// branches that are followed by chance.
struct Account {
    Rgb emitted{0.0};     // towards specular surfaces
    Rgb deposited{0.0};   // on receivers, before their albedo
    Rgb absorbed{0.0};    // by tints, volumes, media and glTF's range; with what is scattered out of the way
    Rgb escaped{0.0};     // left the scene
    Rgb truncated{0.0};   // had more events than are followed
    Rgb correction{0.0};  // added by the adjoint correction of interpolated normals
    void operator+=(const Account& o) {
        emitted += o.emitted, deposited += o.deposited, absorbed += o.absorbed, escaped += o.escaped, truncated += o.truncated, correction += o.correction;
    }
};

}  // namespace nephroid::reference
