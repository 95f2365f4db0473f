// Generates a self-signed certificate. Browsers grant camera access to secure pages only, and a
// phone cannot use localhost. The certificate does not prove the server's identity; browsers ask
// the user once.
#pragma once

#include <string>
#include <vector>

namespace alidade {

struct TlsCertificate {
  std::string certificate, key;  // PEM
  std::string fingerprint;  // SHA-256 of the certificate in the format browsers display: AB:CD:…
};

// Self-signed, EC P-256, valid for 30 days. `names`: addresses and host names of the server. Throws
// std::runtime_error when OpenSSL fails.
TlsCertificate MakeCertificate(const std::vector<std::string>& names);

}  // namespace alidade
