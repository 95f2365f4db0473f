// Compiles the non-template parts of Boost.Asio and Boost.Beast once
// (BOOST_ASIO_SEPARATE_COMPILATION), instead of in every file that uses them.
#include <boost/asio/impl/src.hpp>
#include <boost/beast/src.hpp>
#ifdef ALIDADE_TLS
#include <boost/asio/ssl/impl/src.hpp>
#endif
