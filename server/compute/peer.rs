//! Clients as a server without accounts tells them apart: by the address that a request comes from.

use std::net::{IpAddr, Ipv6Addr, SocketAddr};
use std::str::FromStr;

use ipnet::IpNet;

/// A client, or all clients behind one address. Scarce resources are shared between peers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Peer(IpAddr);

impl Peer {
    /// The peer of a request without a socket, as in tests.
    pub const NOBODY: Self = Self(IpAddr::V6(Ipv6Addr::UNSPECIFIED));

    /// The peer at this address. For IPv6 it is the /64 network, since one client has all of it.
    pub fn at(address: IpAddr) -> Self {
        Self(match address.to_canonical() {
            IpAddr::V6(address) => {
                let [a, b, c, d, ..] = address.segments();
                IpAddr::V6(Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0))
            }
            four => four,
        })
    }

    /// A number for this peer: of the IPv4 address, or of the IPv6 network.
    pub(crate) fn key(self) -> u64 {
        match self.0 {
            IpAddr::V4(address) => u64::from(address.to_bits()),
            IpAddr::V6(network) => (network.to_bits() >> 64) as u64,
        }
    }

    /// The IPv4 address, or the first address of the IPv6 network.
    pub fn address(self) -> IpAddr {
        self.0
    }
}

impl From<SocketAddr> for Peer {
    fn from(address: SocketAddr) -> Self {
        Self::at(address.ip())
    }
}

/// A range of whole addresses. To trust one address is not to trust all peers in its /64 network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Network(IpNet);

impl Network {
    /// Tells whether the address is in the range. An IPv4 address may be written as IPv6.
    pub fn has(self, address: IpAddr) -> bool {
        self.0.contains(&address.to_canonical())
    }
}

impl FromStr for Network {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let why = || "it must be an address, or a network as in 10.244.0.0/16".to_owned();
        if let Ok(address) = text.parse::<IpAddr>() {
            return Ok(Self(address.to_canonical().into()));
        }
        let network: IpNet = text.parse().map_err(|_| why())?;
        // For an IPv4 address written as IPv6, the number of bits has two readings.
        let is_mixed = network.addr() != network.addr().to_canonical();
        if is_mixed { Err(why()) } else { Ok(Self(network)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_is_one_peer() {
        let peer = |text: &str| Peer::at(text.parse().unwrap());
        assert_eq!(peer("2001:db8::1"), peer("2001:db8::ffff:1:2:3"));
        assert_ne!(peer("2001:db8::1"), peer("2001:db8:0:1::1"));
        assert_eq!(peer("::ffff:192.0.2.1"), peer("192.0.2.1"));
        assert_ne!(peer("192.0.2.1"), peer("192.0.2.2"));
    }

    #[test]
    fn a_network_has_the_addresses_that_begin_as_it_does() {
        let has = |network: &str, address: &str| network.parse::<Network>().unwrap().has(address.parse().unwrap());
        for (network, within, without) in [
            ("192.0.2.1", "192.0.2.1", "192.0.2.2"),
            ("::ffff:192.0.2.1", "192.0.2.1", "192.0.2.2"),
            ("10.244.0.0/16", "10.244.255.1", "10.245.0.1"),
            ("10.244.0.0/15", "10.245.0.1", "10.246.0.1"),
            ("0.0.0.0/0", "203.0.113.9", "2001:db8::1"),
            ("192.0.2.1", "::ffff:192.0.2.1", "::ffff:192.0.2.2"),
            ("2001:db8:0:7::1", "2001:db8:0:7::1", "2001:db8:0:7::2"),
            ("2001:db8:0:7::1/64", "2001:db8:0:7::2", "2001:db8:0:8::1"),
            ("2001:db8:0:7::/126", "2001:db8:0:7::3", "2001:db8:0:7::4"),
            ("2001:db8::/32", "2001:db8:ffff::1", "2001:db9::1"),
            ("::/0", "2001:db8::1", "192.0.2.1"),
        ] {
            assert!(has(network, within), "{within} is in {network}");
            assert!(!has(network, without), "{without} is not in {network}");
        }
        for text in [
            "",
            "lab",
            "10.0.0.0/33",
            "10.0.0.0/",
            "10.0.0.0/-1",
            "2001:db8::/129",
            "::ffff:10.0.0.0/8",
            "10.0.0.0/8/8",
        ] {
            assert!(text.parse::<Network>().is_err(), "{text}");
        }
    }
}
