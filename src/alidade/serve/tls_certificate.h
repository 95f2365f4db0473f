// A certificate made on the spot: browsers give the camera to secure pages only, and a phone cannot
// reach localhost. It says nothing of who we are; browsers ask the user once.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct TlsCertificate {
  std::string certificate, key;  // PEM
  std::string fingerprint;       // SHA-256 of the certificate, as browsers show it: AB:CD:…
};

// Self-signed, EC P-256, for 30 days. `names`: addresses and names that we are called by. Throws
// std::runtime_error when OpenSSL fails.
TlsCertificate MakeCertificate(const std::vector<std::string>& names);

}  // namespace alidade
